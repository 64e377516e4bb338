#pragma once

#include "vrml/scene/field_value.h"

#include <type_traits>
#include <utility>

namespace gs::vrml {

/// Numbers of which an element of a field consists, in the order of the file. `kCount` is 0 for types without numbers.
template <class T>
struct ElementNumbers {
  using Number = void;
  static constexpr int kCount = 0;
};
template <class T, int kNumbers>
struct Numbers {
  using Number = T;
  static constexpr int kCount = kNumbers;
};
template <>
struct ElementNumbers<float> : Numbers<float, 1> {};
template <>
struct ElementNumbers<double> : Numbers<double, 1> {};
template <>
struct ElementNumbers<std::int32_t> : Numbers<std::int32_t, 1> {};
template <>
struct ElementNumbers<Color> : Numbers<float, 3> {};
template <>
struct ElementNumbers<Rotation> : Numbers<float, 4> {};
template <int kSize, class T, glm::qualifier kQualifier>
struct ElementNumbers<glm::vec<kSize, T, kQualifier>> : Numbers<T, kSize> {};
inline constexpr int kMaxNumbers = 16;  // numbers of the largest element, SFMatrix4d

/// Element type that consists of numbers: SFFloat, glm::dmat4, ...
template <class T>
concept NumberElement = ElementNumbers<T>::kCount >
0;

template <NumberElement T>
[[nodiscard]] const typename ElementNumbers<T>::Number* numbers_of(const T& element) {
  using Number = typename ElementNumbers<T>::Number;
  static_assert(sizeof(T) == sizeof(Number) * ElementNumbers<T>::kCount);
  return reinterpret_cast<const Number*>(&element);
}
template <NumberElement T>
[[nodiscard]] typename ElementNumbers<T>::Number* numbers_of(T& element) {
  return const_cast<typename ElementNumbers<T>::Number*>(numbers_of(std::as_const(element)));
}
/// Returns the element with these numbers, converted to its precision.
template <NumberElement T>
[[nodiscard]] T element_from(const double* from) {
  using Number = typename ElementNumbers<T>::Number;
  T element{};
  for (int i = 0; i < ElementNumbers<T>::kCount; ++i) numbers_of(element)[i] = static_cast<Number>(from[i]);
  return element;
}

/// Type of the elements of an alternative of FieldValue: the type in a box, or of the elements of a list.
template <class T>
struct ElementOfValue {
  using Type = T;
};
template <class T>
struct ElementOfValue<Array<T>> {
  using Type = T;
};
template <class T>
using ElementOf = typename ElementOfValue<T>::Type;

/// Returns the element in an SF value.
template <class T>
[[nodiscard]] const T& element_in(const T& value) {
  return value;
}

}  // namespace gs::vrml
