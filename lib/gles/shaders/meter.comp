// A group for each region: sums in shared memory, then one write; histograms in shared memory, then added to the frame's.

layout(local_size_x = 16, local_size_y = 8) in;

#define THREADS 128u

shared ivec2 sums[THREADS];   // exponents, fractions
shared uvec3 counts[THREADS]; // black, clipped, bad
#ifdef HISTOGRAM
shared uint own_bin[BINS + PEAK_BINS];
shared uint own_peak;

#define FIRST_STOP 95u // 127 - 32

void count_pixel(vec2 l)
{
    uvec2 bits = floatBitsToUint(l);
    atomicAdd(own_bin[(bits.x >> 20) - FIRST_STOP * 8u], 1u);
    atomicAdd(own_bin[BINS + (bits.y >> 21) - FIRST_STOP * 4u], 1u);
    atomicMax(own_peak, bits.y); // positive floats are in the order of their bits
}

void add_histogram(uint i, uint weight)
{
    for (uint b = i; b < BINS + PEAK_BINS; b += THREADS) {
        uint more = own_bin[b] * weight;
        if (more == 0u)
            continue;
        uint before = atomicAdd(statistics.bin[b].x, more);
        if (before > 0xffffffffu - more)
            atomicAdd(statistics.bin[b].y, 1u);
    }
    if (i == 0u)
        atomicMax(statistics.peak.x, own_peak);
}
#endif

void sum_up(uint i)
{
    for (uint half_of = THREADS / 2u; half_of > 0u; half_of /= 2u) {
        if (i < half_of) {
            sums[i] += sums[i + half_of];
            counts[i] += counts[i + half_of];
        }
        memoryBarrierShared();
        barrier();
    }
}

// A region that has pixels: all of the group does this, or none.
void meter_region(ivec2 region, ivec4 row, int first_x, int end_x, uint weight, uint i, uint index)
{
    ivec2 here = ivec2(gl_LocalInvocationID.xy);
    run r = run(1.0, 0, 0u, 0u, 0u);
#ifdef HISTOGRAM
    for (uint b = i; b < BINS + PEAK_BINS; b += THREADS)
        own_bin[b] = 0u;
    if (i == 0u)
        own_peak = 0u;
    memoryBarrierShared();
    barrier();
#endif
    for (int y = row.x + here.y; y < row.y; y += 8)
        for (int x = first_x + here.x; x < end_x; x += 16) {
            vec2 l = meter_pixel(load_metered(ivec2(x, y)), r);
#ifdef HISTOGRAM
            count_pixel(l);
#endif
        }
    sums[i] = ivec2(r.exponent, int(fraction_of(r)));
    counts[i] = uvec3(r.black, r.clipped, r.bad);
    memoryBarrierShared();
    barrier();
    sum_up(i);
    if (i == 0u)
        statistics.region[index] = pack_sums(sums[0].x, uint(sums[0].y), counts[0].x, counts[0].y, counts[0].z);
#ifdef HISTOGRAM
    add_histogram(i, weight);
#endif
}

void main()
{
    ivec2 region = ivec2(gl_WorkGroupID.xy);
    uint i = gl_LocalInvocationIndex, index = gl_WorkGroupID.y * uint(REGION_COLUMNS) + gl_WorkGroupID.x;
    uint weight = weight_of(region);
    int first_x = first_column(region.x), end_x = first_column(region.x + 1);
    if (weight > 0u && end_x > first_x)
        meter_region(region, region_row[region.y], first_x, end_x, weight, i, index);
    else if (i == 0u)
        statistics.region[index] = uvec4(0u);
}
