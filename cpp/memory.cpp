#include "cpp/memory.h"

#include <cstring>

#if defined(__linux__)
#include <sys/mman.h>
#endif
#if defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace formwork {

void prefer_huge_pages(std::size_t address, std::size_t bytes) noexcept {
#if defined(MADV_HUGEPAGE)
    // Every huge page that holds some of them, whatever else it holds: what lies side by side is to share them, and a
    // mapping of which only a part was spoken of is two to the system, which then cannot grow it without copying.
    std::size_t const page = std::size_t(2) << 20;
    std::size_t begin = address / page * page;
    std::size_t end = (address + bytes + page - 1) / page * page;
    if (begin < end) {
        // A refusal leaves pages as they are.
        (void)madvise(reinterpret_cast<void *>(static_cast<std::uintptr_t>(begin)), end - begin, MADV_HUGEPAGE);
    }
#else
    (void)address;
    (void)bytes;
#endif
}

void store_past_caches(std::uint8_t *to, std::uint8_t const *from, std::size_t bytes) noexcept {
    std::size_t done = 0;
#if defined(__SSE2__)
    if (reinterpret_cast<std::uintptr_t>(to) % sizeof(__m128i) == 0) {
        for (; done + sizeof(__m128i) <= bytes; done += sizeof(__m128i)) {
            __m128i const value = _mm_loadu_si128(reinterpret_cast<__m128i const *>(from + done));
            _mm_stream_si128(reinterpret_cast<__m128i *>(to + done), value);
        }
    }
#endif
    if (done < bytes) {
        std::memcpy(to + done, from + done, bytes - done);
    }
}

void finish_stores() noexcept {
#if defined(__SSE2__)
    _mm_sfence();
#endif
}

} // namespace formwork
