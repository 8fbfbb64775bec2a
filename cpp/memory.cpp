#include "cpp/memory.h"

#include <cstdint>

#if defined(__linux__)
#include <sys/mman.h>
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

} // namespace formwork
