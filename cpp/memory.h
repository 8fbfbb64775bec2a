// What the system and the processor offer for memory, and Rust's standard library does not.
#pragma once

#include <cstddef>
#include <cstdint>

namespace formwork {

// Asks for huge pages under the bytes from `address` on, where the system has them. Touches nothing: any range will do.
void prefer_huge_pages(std::size_t address, std::size_t bytes) noexcept;

// Copies bytes between ranges that do not overlap, past the caches where the processor can. Other threads may see them
// late, until this one has called `finish_stores`.
void store_past_caches(std::uint8_t *to, std::uint8_t const *from, std::size_t bytes) noexcept;
void finish_stores() noexcept;

} // namespace formwork
