#pragma once
#include <cstddef>
#include <new>
#include <vector>

namespace pdx {
/// Memory that begins on a line of the cache, so that no vector of eight doubles lies in two.
template <class T> struct AlignedAllocator {
  using value_type = T;
  static constexpr std::align_val_t kLine{64};

  AlignedAllocator() = default;
  template <class Other> AlignedAllocator(const AlignedAllocator<Other>&) noexcept {}
  T* allocate(std::size_t count) { return static_cast<T*>(::operator new(count * sizeof(T), kLine)); }
  void deallocate(T* memory, std::size_t) noexcept { ::operator delete(memory, kLine); }
  bool operator==(const AlignedAllocator&) const noexcept { return true; }
};
template <class T> using AlignedVector = std::vector<T, AlignedAllocator<T>>;
} // namespace pdx
