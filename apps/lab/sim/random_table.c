/* The results of random cameras, by their faults. */
#include <math.h>

#include "sim.h"

enum { NO_FAULT = FIXTURE_FAULTS_AND_LIGHTS, ALL_CAMERAS };

static void count(sim_fault_row *row, const fixture_verdict *v)
{
    row->cameras++;
    row->wrong += v->wrong != 0;
    row->excused += v->side != 0;
    row->shown_ev = fmax(row->shown_ev, fabs(v->shown_ev));
    row->sensor_ev = fmax(row->sensor_ev, fabs(v->sensor_ev));
}

void sim_count_faults(sim_fault_table *t, uint32_t faults, const fixture_verdict *v)
{
    int camera_faults = 0;
    for (int i = 0; i < FIXTURE_FAULTS_AND_LIGHTS; i++) {
        if (!(faults >> i & 1))
            continue;
        count(&t->row[i], v);
        camera_faults += i < FIXTURE_FAULTS;
    }
    if (!camera_faults)
        count(&t->row[NO_FAULT], v);
    count(&t->row[ALL_CAMERAS], v);
    t->pairs += camera_faults > 1;
}

static const char *name_of(int row)
{
    return row == ALL_CAMERAS ? "all cameras" : row == NO_FAULT ? "none" : fixture_fault_name[row];
}

static void print_json(const sim_fault_table *t)
{
    printf("\"pairs\":%llu,\"faults\":[", (unsigned long long)t->pairs);
    for (int i = 0; i <= ALL_CAMERAS; i++) {
        const sim_fault_row *r = &t->row[i];
        printf("%s{\"fault\":\"%s\",\"cameras\":%llu,\"failed\":%llu,\"shown_ev\":%.4f,\"sensor_ev\":%.4f,"
               "\"excused\":%llu}",
               i ? "," : "", name_of(i), (unsigned long long)r->cameras, (unsigned long long)r->wrong, r->shown_ev,
               r->sensor_ev, (unsigned long long)r->excused);
    }
    puts("]}");
}

void sim_print_faults(const sim_fault_table *t, int json)
{
    const double all = fmax(1.0, (double)t->row[ALL_CAMERAS].cameras);
    if (json) {
        print_json(t);
        return;
    }
    printf("%-36s%10s%8s%10s%12s%12s%10s\n", "fault", "cameras", "share", "failed", "shown, EV", "sensor, EV",
           "excused");
    for (int i = 0; i <= ALL_CAMERAS; i++) {
        const sim_fault_row *r = &t->row[i];
        const double cameras = fmax(1.0, (double)r->cameras);
        printf("%-36s%10llu%7.1f%%%10llu%12.3f%12.3f%9.1f%%\n", name_of(i), (unsigned long long)r->cameras,
               100.0 * (double)r->cameras / all, (unsigned long long)r->wrong, r->shown_ev, r->sensor_ev,
               100.0 * (double)r->excused / cameras);
    }
    printf("two faults or more: %.1f%%; excused: the aim is out of reach, which has to be named\n",
           100.0 * (double)t->pairs / all);
}
