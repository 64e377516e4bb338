#pragma once

#include "vrml/scene/values/field_value.h"

#include <algorithm>
#include <cstdint>
#include <type_traits>

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
struct ElementNumbers<Double> : Numbers<double, 1> {};
template <>
struct ElementNumbers<std::int32_t> : Numbers<std::int32_t, 1> {};
template <>
struct ElementNumbers<Color> : Numbers<float, 3> {};
template <>
struct ElementNumbers<ColorRGBA> : Numbers<float, 4> {};
template <>
struct ElementNumbers<Rotation> : Numbers<float, 4> {};
template <int kSize, class T, glm::qualifier kQualifier>
struct ElementNumbers<glm::vec<kSize, T, kQualifier>> : Numbers<T, kSize> {};
template <int kColumns, int kRows, class T, glm::qualifier kQualifier>
struct ElementNumbers<glm::mat<kColumns, kRows, T, kQualifier>> : Numbers<T, kColumns * kRows> {};

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
/// Returns the element with these numbers, converted to its precision. Integers are clamped to 32 bits; NaN becomes the
/// least one.
template <NumberElement T>
[[nodiscard]] T element_from(const double* from) {
  using Number = typename ElementNumbers<T>::Number;
  T element{};
  for (int i = 0; i < ElementNumbers<T>::kCount; ++i) {
    double number = from[i];
    if constexpr (std::is_same_v<Number, std::int32_t>)
      number = std::min(std::max(-2147483648.0, number), 2147483647.0);
    numbers_of(element)[i] = static_cast<Number>(number);
  }
  return element;
}

/// Type of the elements of an alternative of FieldValue: the type in a box, or of the elements of a list.
template <class T>
struct ElementOfValue {
  using Type = T;
};
template <class T, int kInitial>
struct ElementOfValue<Boxed<T, kInitial>> {
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
template <class T, int kInitial>
[[nodiscard]] const T& element_in(const Boxed<T, kInitial>& value) {
  return *value;
}

/// Alternative of FieldValue for an element: a box if the element is large.
template <class T>
struct SingleValueOf {
  using Type = T;
};
template <class T>
requires(sizeof(T) > 16 && NumberElement<T>) struct SingleValueOf<T> {
  using Type = Boxed < T, requires { typename T::col_type; }
  ? 1 : 0 > ;
};
template <class T>
using SingleValue = typename SingleValueOf<T>::Type;

/// Returns the SF value of an element.
template <class T>
[[nodiscard]] FieldValue single_value_of(const T& element) {
  return FieldValue(std::in_place_type<SingleValue<T>>, element);
}

/// Writes the numbers of an SF value to `numbers`, which has room for kMaxNumbers. Other values change nothing.
void read_numbers(const FieldValue& value, double* numbers);
/// Sets the numbers of an SF value, or appends an element of these numbers to an MF value. Ignores values without
/// numbers.
void write_numbers(FieldValue& value, const double* numbers);
/// Returns the count of numbers in an element of a type; 0 for SFBool, SFImage, SFNode, SFString and their MF types.
[[nodiscard]] int number_count(FieldType type);

}  // namespace gs::vrml
