#include "vrml/scene/values/field_value.h"

#include "vrml/scene/values/field_numbers.h"

#include <array>
#include <utility>

namespace gs::vrml {
namespace {

constexpr std::array<std::string_view, kFieldTypeCount> kNames = {
    "SFBool",     "SFColor",    "SFColorRGBA", "SFDouble",   "SFFloat", "SFImage",    "SFInt32",
    "SFMatrix3d", "SFMatrix3f", "SFMatrix4d",  "SFMatrix4f", "SFNode",  "SFRotation", "SFString",
    "SFTime",     "SFVec2d",    "SFVec2f",     "SFVec3d",    "SFVec3f", "SFVec4d",    "SFVec4f",
    "MFBool",     "MFColor",    "MFColorRGBA", "MFDouble",   "MFFloat", "MFImage",    "MFInt32",
    "MFMatrix3d", "MFMatrix3f", "MFMatrix4d",  "MFMatrix4f", "MFNode",  "MFRotation", "MFString",
    "MFTime",     "MFVec2d",    "MFVec2f",     "MFVec3d",    "MFVec3f", "MFVec4d",    "MFVec4f"};

template <std::size_t kIndex>
FieldValue initial_at() {
  using T = std::variant_alternative_t<kIndex, FieldValue>;
  // glm leaves vectors uninitialised by default.
  if constexpr (requires { T::length(); })
    return FieldValue(std::in_place_index<kIndex>, 0);
  else
    return FieldValue(std::in_place_index<kIndex>);
}

template <std::size_t... kIndices>
constexpr auto initial_values(std::index_sequence<kIndices...>) {
  return std::array<FieldValue (*)(), kFieldTypeCount>{initial_at<kIndices>...};
}
constexpr auto kInitialValues = initial_values(std::make_index_sequence<kFieldTypeCount>{});

template <std::size_t... kIndices>
constexpr auto number_counts(std::index_sequence<kIndices...>) {
  return std::array<std::uint8_t, kSingleTypeCount>{static_cast<std::uint8_t>(
      ElementNumbers<ElementOf<std::variant_alternative_t<kIndices, FieldValue>>>::kCount)...};
}
constexpr auto kNumberCounts = number_counts(std::make_index_sequence<kSingleTypeCount>{});

}  // namespace

std::string_view name_of(FieldType type) { return kNames[static_cast<std::size_t>(type)]; }

std::optional<FieldType> field_type_named(std::string_view name) {
  for (std::size_t i = 0; i < kNames.size(); ++i)
    if (kNames[i] == name) return static_cast<FieldType>(i);
  return std::nullopt;
}

FieldValue initial_value(FieldType type) { return kInitialValues[static_cast<std::size_t>(type)](); }

int number_count(FieldType type) { return kNumberCounts[static_cast<std::size_t>(element_type(type))]; }

void read_numbers(const FieldValue& value, double* numbers) {
  std::visit(
      [&](const auto& one) {
        if constexpr (requires { one.span(); }) {
          return;
        } else if constexpr (NumberElement<ElementOf<std::decay_t<decltype(one)>>>) {
          const auto& element = element_in(one);
          constexpr int kCount = ElementNumbers<std::decay_t<decltype(element)>>::kCount;
          for (int i = 0; i < kCount; ++i) numbers[i] = static_cast<double>(numbers_of(element)[i]);
        }
      },
      value);
}

void write_numbers(FieldValue& value, const double* numbers) {
  std::visit(
      [&](auto& one) {
        using Element = ElementOf<std::decay_t<decltype(one)>>;
        if constexpr (NumberElement<Element>) {
          const auto element = element_from<Element>(numbers);
          if constexpr (requires { one.span(); })
            one.push_back(element);
          else
            one = element;
        }
      },
      value);
}

std::size_t element_count(const FieldValue& value) {
  return std::visit(
      [](const auto& one) -> std::size_t {
        if constexpr (requires { one.span(); })
          return one.size();
        else
          return 1;
      },
      value);
}

}  // namespace gs::vrml
