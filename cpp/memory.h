// Advice to the system about memory.
#pragma once

#include <cstddef>

namespace formwork {

// Asks for huge pages under the bytes from `address` on, where the system has them. Touches nothing: any range will do.
void prefer_huge_pages(std::size_t address, std::size_t bytes) noexcept;

} // namespace formwork
