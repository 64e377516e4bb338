#include "vrml/scene/field_value.h"

#include <array>

namespace gs::vrml {
namespace {

constexpr std::array<std::string_view, kFieldTypeCount> kNames = {
    "SFBool",   "SFColor",    "SFFloat",  "SFImage", "SFInt32", "SFNode",  "SFRotation",
    "SFString", "SFTime",     "SFVec2f",  "SFVec3f", "MFColor", "MFFloat", "MFInt32",
    "MFNode",   "MFRotation", "MFString", "MFTime",  "MFVec2f", "MFVec3f"};

template <std::size_t... I>
FieldValue initial_at(std::size_t index, std::index_sequence<I...>) {
  FieldValue value;
  ((index == I ? void(value.emplace<I>()) : void()), ...);
  return value;
}

}  // namespace

std::string_view name_of(FieldType type) { return kNames[static_cast<std::size_t>(type)]; }

std::optional<FieldType> field_type_named(std::string_view name) {
  for (std::size_t i = 0; i < kNames.size(); ++i)
    if (kNames[i] == name) return static_cast<FieldType>(i);
  return std::nullopt;
}

FieldValue initial_value(FieldType type) {
  FieldValue value = initial_at(static_cast<std::size_t>(type), std::make_index_sequence<kFieldTypeCount>{});
  // Sets vectors to 0, because glm leaves them uninitialised by default.
  if (auto* v = std::get_if<SFVec2f>(&value)) *v = SFVec2f(0);
  if (auto* v = std::get_if<SFVec3f>(&value)) *v = SFVec3f(0);
  return value;
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
