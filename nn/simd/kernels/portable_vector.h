// A vector register of 16 bytes on any processor: the compiler's own vectors, with the functions of xsimd's
// batches that the kernels call.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

namespace penumbra::nn::PENUMBRA_ISA {

namespace {  // so that no object shares its functions with another

#define PENUMBRA_INLINE __attribute__((always_inline)) inline

template <class T>
struct Lanes;
template <>
struct Lanes<float> {
  using Type [[gnu::vector_size(16)]] = float;
};
template <>
struct Lanes<std::uint8_t> {
  using Type [[gnu::vector_size(16)]] = std::uint8_t;
};

template <class T>
struct PortableVector {
  static constexpr std::size_t size = 16 / sizeof(T);
  using Data = typename Lanes<T>::Type;
  Data data;

  PortableVector() = default;
  PENUMBRA_INLINE PortableVector(Data lanes) : data(lanes) {}
  PENUMBRA_INLINE explicit PortableVector(T value) : data(Data{} + value) {}
  PENUMBRA_INLINE static PortableVector load_unaligned(const T* from) {
    PortableVector v;
    std::memcpy(&v.data, from, sizeof v.data);
    return v;
  }
  PENUMBRA_INLINE static PortableVector load_aligned(const T* from) { return load_unaligned(from); }
  PENUMBRA_INLINE void store_unaligned(T* to) const { std::memcpy(to, &data, sizeof data); }
  PENUMBRA_INLINE T get(std::size_t lane) const { return data[lane]; }
  PENUMBRA_INLINE PortableVector& operator+=(const PortableVector& other) {
    data += other.data;
    return *this;
  }

  friend PENUMBRA_INLINE PortableVector operator+(const PortableVector& a, const PortableVector& b) {
    return a.data + b.data;
  }
  friend PENUMBRA_INLINE PortableVector operator-(const PortableVector& a, const PortableVector& b) {
    return a.data - b.data;
  }
  friend PENUMBRA_INLINE PortableVector operator*(const PortableVector& a, const PortableVector& b) {
    return a.data * b.data;
  }
  // Each lane all ones or 0.
  friend PENUMBRA_INLINE auto operator>(const PortableVector& a, const PortableVector& b) {
    return a.data > b.data;
  }
  // Where a lane of `b` is NaN it stays, as SSE's instructions have it.
  friend PENUMBRA_INLINE PortableVector max(const PortableVector& a, const PortableVector& b) {
    return a.data > b.data ? a.data : b.data;
  }
  friend PENUMBRA_INLINE PortableVector min(const PortableVector& a, const PortableVector& b) {
    return a.data < b.data ? a.data : b.data;
  }
  // Of whole numbers without a sign: 0 where `b` is greater.
  friend PENUMBRA_INLINE PortableVector ssub(const PortableVector& a, const PortableVector& b) {
    return max(a, b).data - b.data;
  }
  friend PENUMBRA_INLINE T hadd(const PortableVector& a) {
    T sum = a.data[0];
    for (std::size_t i = 1; i < size; ++i) sum = static_cast<T>(sum + a.data[i]);
    return sum;
  }
};

template <class Mask>
PENUMBRA_INLINE bool any(const Mask& lanes) {
  unsigned long long halves[2];
  static_assert(sizeof(lanes) == sizeof(halves));
  std::memcpy(halves, &lanes, sizeof halves);
  return (halves[0] | halves[1]) != 0;
}

template <class Mask, class T>
PENUMBRA_INLINE PortableVector<T> select(const Mask& lanes, const PortableVector<T>& a,
                                         const PortableVector<T>& b) {
  return lanes ? a.data : b.data;
}

#undef PENUMBRA_INLINE

}  // namespace

}  // namespace penumbra::nn::PENUMBRA_ISA
