/* The reader of PNG under libFuzzer. Most changed bytes would only spoil a chunk's checksum: three of four inputs get
 * theirs corrected, so that the code behind the check is reached. */
#define READER pupil_read_png
#include "fuzz_still.h"

/* libFuzzer's own mutation, and its hook for ours. */
size_t LLVMFuzzerMutate(uint8_t *data, size_t size, size_t max_size);
size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t size, size_t max_size, unsigned int seed);

static uint32_t checksum(const uint8_t *data, size_t size) /* PNG, annex D */
{
    uint32_t crc = 0xffffffff;
    for (size_t i = 0; i < size; i++) {
        crc ^= data[i];
        for (int bit = 0; bit < 8; bit++)
            crc = crc & 1 ? crc >> 1 ^ 0xedb88320 : crc >> 1;
    }
    return ~crc;
}

size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t size, size_t max_size, unsigned int seed)
{
    size = LLVMFuzzerMutate(data, size, max_size);
    for (size_t at = 8; seed % 4 && size >= 12 && at <= size - 12;) {
        const uint32_t length = (uint32_t)data[at] << 24 | (uint32_t)data[at + 1] << 16 | (uint32_t)data[at + 2] << 8 |
                                (uint32_t)data[at + 3];
        uint32_t crc;
        if (length > size - at - 12)
            break;
        crc = checksum(data + at + 4, (size_t)length + 4);
        for (int i = 0; i < 4; i++)
            data[at + 8 + length + (size_t)i] = (uint8_t)(crc >> (24 - 8 * i));
        at += 12 + (size_t)length;
    }
    return size;
}
