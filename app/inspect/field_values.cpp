#include "app/inspect/field_values.h"

#include "base/text.h"
#include "vrml/scene/values/field_numbers.h"
#include "vrml/syntax/printer.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <utility>

namespace gs::app {
namespace {

using vrml::FieldType;
using vrml::NodeKind;

constexpr std::size_t kElements = 6, kText = 200;          // max number of elements and of characters to show
constexpr std::size_t kEdited = 64, kEditedText = 16'000;  // max number of elements and of bytes to edit on one line

// Row of the table of units. Gives the unit of the fields with this name and type, for one node type or
// (NodeKind::other) for all.
struct UnitRow {
  std::string_view field;
  FieldType type;
  Unit unit;
  NodeKind of = NodeKind::other;
};
constexpr UnitRow kFieldUnits[] = {
    {"fieldOfView", FieldType::SFFloat, Unit::radians},
    {"creaseAngle", FieldType::SFFloat, Unit::radians},
    {"cutOffAngle", FieldType::SFFloat, Unit::radians},
    {"beamWidth", FieldType::SFFloat, Unit::radians},
    {"minAngle", FieldType::SFFloat, Unit::radians},
    {"maxAngle", FieldType::SFFloat, Unit::radians},
    {"diskAngle", FieldType::SFFloat, Unit::radians},
    {"offset", FieldType::SFFloat, Unit::radians},
    {"skyAngle", FieldType::MFFloat, Unit::radians},
    {"groundAngle", FieldType::MFFloat, Unit::radians},
    {"rotation", FieldType::SFFloat, Unit::radians},
    {"radius", FieldType::SFFloat, Unit::metres},
    {"height", FieldType::SFFloat, Unit::metres},
    {"height", FieldType::MFFloat, Unit::metres},
    {"bottomRadius", FieldType::SFFloat, Unit::metres},
    {"xSpacing", FieldType::SFFloat, Unit::metres},
    {"zSpacing", FieldType::SFFloat, Unit::metres},
    {"maxBack", FieldType::SFFloat, Unit::metres},
    {"maxFront", FieldType::SFFloat, Unit::metres},
    {"minBack", FieldType::SFFloat, Unit::metres},
    {"minFront", FieldType::SFFloat, Unit::metres},
    {"visibilityLimit", FieldType::SFFloat, Unit::metres},
    {"visibilityRange", FieldType::SFFloat, Unit::metres},
    {"range", FieldType::MFFloat, Unit::metres},
    {"avatarSize", FieldType::MFFloat, Unit::metres},
    {"size", FieldType::SFFloat, Unit::metres},
    {"maxExtent", FieldType::SFFloat, Unit::metres},
    {"length", FieldType::MFFloat, Unit::metres},
    {"crossSection", FieldType::MFVec2f, Unit::metres},
    {"minPosition", FieldType::SFVec2f, Unit::metres},
    {"maxPosition", FieldType::SFVec2f, Unit::metres},
    {"translation", FieldType::SFVec3f, Unit::metres},
    {"center", FieldType::SFVec3f, Unit::metres},
    {"location", FieldType::SFVec3f, Unit::metres},
    {"position", FieldType::SFVec3f, Unit::metres},
    {"size", FieldType::SFVec3f, Unit::metres},
    {"bboxCenter", FieldType::SFVec3f, Unit::metres},
    {"bboxSize", FieldType::SFVec3f, Unit::metres},
    {"offset", FieldType::SFVec3f, Unit::metres},
    {"trackPoint", FieldType::SFVec3f, Unit::metres},
    {"hitPoint", FieldType::SFVec3f, Unit::metres},
    {"point", FieldType::MFVec3f, Unit::metres},
    {"spine", FieldType::MFVec3f, Unit::metres},
    {"controlPoint", FieldType::MFVec3f, Unit::metres},
    {"speed", FieldType::SFFloat, Unit::metres_a_second, NodeKind::navigation_info},
};

std::string_view plain_name(std::string_view name) {
  if (name.starts_with("set_")) return name.substr(4);
  constexpr std::string_view kChanged = "_changed";
  return name.ends_with(kChanged) ? name.substr(0, name.size() - kChanged.size()) : name;
}

// Replaces control characters, so that the text stays on one line.
std::string on_a_line(std::string text) {
  for (char& letter : text)
    if (static_cast<unsigned char>(letter) < 0x20) letter = ' ';
  return text;
}

std::string image_text(const vrml::SFImage& image) {
  return std::to_string(image.width()) + " x " + std::to_string(image.height()) + " pixels of " +
         std::to_string(image.components()) + (image.components() == 1 ? " component" : " components");
}

vrml::SFString cut_text(const vrml::SFString& text) {
  return text.view().size() <= kText ? text : vrml::SFString(shortened(text.str().substr(0, 2 * kText), kText));
}

}  // namespace

std::string_view symbol_of(Unit unit) {
  constexpr std::array<std::string_view, 5> kSymbols = {"", "m", "rad", "s", "m/s"};
  return kSymbols[static_cast<std::size_t>(unit)];
}

Unit unit_of(const vrml::NodeType& type, const vrml::InterfaceDeclaration& field) {
  if (field.type == FieldType::SFTime || field.type == FieldType::MFTime) return Unit::seconds;
  if (field.type == FieldType::SFRotation || field.type == FieldType::MFRotation) return Unit::radians;
  if (type.kind != vrml::NodeType::Kind::built_in) return Unit::none;
  const std::string_view name = plain_name(field.name);
  for (const UnitRow& row : kFieldUnits)
    if (row.field == name && row.type == field.type && (row.of == NodeKind::other || row.of == type.read_as))
      return row.unit;
  return Unit::none;
}

vrml::FieldValue element_of(const vrml::FieldValue& value, std::size_t index) {
  return std::visit(
      [&](const auto& one) -> vrml::FieldValue {
        if constexpr (requires { one.span(); })
          return vrml::single_value_of(one[index]);
        else
          return one;
      },
      value);
}

bool set_element(vrml::FieldValue& value, std::size_t index, const vrml::FieldValue& element) {
  return std::visit(
      [&](auto& one) {
        using Value = std::decay_t<decltype(one)>;
        if constexpr (requires { one.span(); }) {
          const auto* const other = std::get_if<vrml::SingleValue<vrml::ElementOf<Value>>>(&element);
          if (!other || index >= one.size()) return false;
          one.mutable_data()[index] = vrml::element_in(*other);
          return true;
        } else {
          const auto* const other = std::get_if<Value>(&element);
          if (!other || index != 0) return false;
          one = *other;
          return true;
        }
      },
      value);
}

std::string value_text(const vrml::FieldValue& value, const vrml::SceneGraph& scene) {
  if (const auto* image = std::get_if<vrml::SFImage>(&value)) return image_text(*image);
  if (const auto* images = std::get_if<vrml::MFImage>(&value)) {
    std::string text = "[";
    for (std::size_t i = 0; i < images->size() && i < kElements; ++i)
      text += (i > 0 ? ", " : " ") + image_text((*images)[i]);
    return text + (images->size() > kElements ? ", ... ]" : images->empty() ? "]" : " ]");
  }
  std::string text;
  if (const auto* string = std::get_if<vrml::SFString>(&value)) {
    vrml::print_value(text, cut_text(*string), scene);
    return on_a_line(std::move(text));
  }
  const std::size_t count = vrml::element_count(value);
  std::visit(
      [&](const auto& one) {
        using Value = std::decay_t<decltype(one)>;
        if constexpr (requires { one.span(); }) {
          Value some(one.span().first(std::min(count, kElements)));
          if constexpr (std::is_same_v<Value, vrml::MFString>)
            for (std::size_t i = 0; i < some.size(); ++i) some.mutable_data()[i] = cut_text(some[i]);
          vrml::print_value(text, some, scene);
        } else {
          vrml::print_value(text, one, scene);
        }
      },
      value);
  text = on_a_line(std::move(text));
  if (count > kElements && text.ends_with(']')) text.replace(text.size() - 1, 1, "... ]");
  return shortened(text, 3 * kText);
}

std::optional<std::string> editable_text(const vrml::FieldValue& value, const vrml::SceneGraph& scene) {
  if (const auto* image = std::get_if<vrml::SFImage>(&value); image && image->words.size() > kEdited)
    return std::nullopt;
  if (const auto* string = std::get_if<vrml::SFString>(&value); string && string->view().size() > kEditedText)
    return std::nullopt;
  if (vrml::element_count(value) > kEdited) return std::nullopt;
  if (const auto* images = std::get_if<vrml::MFImage>(&value))
    for (const vrml::SFImage& image : *images)
      if (image.words.size() > kEdited) return std::nullopt;
  if (const auto* strings = std::get_if<vrml::MFString>(&value))
    for (const vrml::SFString& one : *strings)
      if (one.view().size() > kEditedText) return std::nullopt;
  std::string text;
  vrml::print_value(text, value, scene);
  return text.size() > kEditedText ? std::nullopt : std::optional(std::move(text));
}

std::string degrees_text(double radians) {
  char text[64];
  const double degrees = radians * 180 / std::numbers::pi;
  std::snprintf(text, sizeof text, "%.1f", degrees);
  std::string result = text;
  if (result.ends_with(".0")) result.resize(result.size() - 2);
  if (result == "-0") result = "0";
  return result + " deg";
}

bool is_date(double seconds) {
  constexpr double kFirst = 315532800, kLast = 32503680000;  // seconds from 1970 to the years 1980 and 3000
  return seconds >= kFirst && seconds < kLast;
}

std::string time_text(double seconds) {
  char text[96];
  if (!is_date(seconds)) {
    std::snprintf(text, sizeof text, "%.3f", seconds);
    return text;
  }
  using namespace std::chrono;
  const double whole = std::floor(seconds);
  const sys_seconds at{std::chrono::seconds(static_cast<std::int64_t>(whole))};
  const sys_days day = floor<days>(at);
  const year_month_day date(day);
  const hh_mm_ss clock(at - day);
  std::snprintf(text, sizeof text, "%04d-%02u-%02u %02d:%02d:%02d.%02d", static_cast<int>(date.year()),
                static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()),
                static_cast<int>(clock.hours().count()), static_cast<int>(clock.minutes().count()),
                static_cast<int>(clock.seconds().count()), static_cast<int>((seconds - whole) * 100));
  return text;
}

}  // namespace gs::app
