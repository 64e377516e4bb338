#include "app/inspect/field_edits.h"

#include "app/script/run_time_nodes.h"
#include "vrml/scene/values/field_numbers.h"

#include <charconv>
#include <cmath>
#include <limits>
#include <numbers>
#include <string_view>
#include <utility>

namespace gs::app {
namespace {

using vrml::AccessType;
using vrml::FieldType;

struct Interval {
  double lower = 0, upper = 0;
  bool lower_open = false, upper_open = false;

  [[nodiscard]] bool has(double number) const {
    return (lower_open ? number > lower : number >= lower) && (upper_open ? number < upper : number <= upper);
  }
};

// Parses one bound of an interval: "2", "inf", "-2pi", "pi/2".
std::optional<double> bound_of(std::string_view text) {
  const bool negative = text.starts_with('-');
  if (negative) text.remove_prefix(1);
  double divisor = 1, factor = 1;
  if (text.ends_with("/2")) {
    divisor = 2;
    text.remove_suffix(2);
  }
  if (text.ends_with("pi")) {
    factor = std::numbers::pi;
    text.remove_suffix(2);
  }
  double number = 1;
  if (text == "inf") {
    number = std::numeric_limits<double>::infinity();
  } else if (!text.empty()) {
    const auto read = std::from_chars(text.data(), text.data() + text.size(), number);
    if (read.ec != std::errc() || read.ptr != text.data() + text.size()) return std::nullopt;
  } else if (factor == 1) {
    return std::nullopt;
  }
  return (negative ? -number : number) * factor / divisor;
}

// Parses an interval such as "[0,1]" at the start of a text, and removes it from the text.
std::optional<Interval> take_interval(std::string_view& text) {
  const std::size_t comma = text.find(','), end = text.find_first_of(")]");
  if (text.empty() || (text[0] != '[' && text[0] != '(') || comma == text.npos || end == text.npos || comma > end)
    return std::nullopt;
  const auto lower = bound_of(text.substr(1, comma - 1)), upper = bound_of(text.substr(comma + 1, end - comma - 1));
  if (!lower || !upper) return std::nullopt;
  const Interval interval{*lower, *upper, text[0] == '(', text[end] == ')'};
  text.remove_prefix(end + 1);
  return interval;
}

std::string number_text(double number) {
  char digits[32];
  if (const double part = number / std::numbers::pi; part == 1 || part == 2 || part == -2 || part == 0.5)
    return part == 1 ? "pi" : part == 2 ? "2 pi" : part == -2 ? "-2 pi" : "pi/2";
  return {digits, std::to_chars(digits, digits + sizeof digits, static_cast<float>(number)).ptr};
}

std::string range_words(const Interval& one) {
  std::string words;
  if (std::isfinite(one.lower)) words = (one.lower_open ? "more than " : "at least ") + number_text(one.lower);
  if (std::isfinite(one.upper))
    words += (words.empty() ? "" : " and ") + std::string(one.upper_open ? "less than " : "at most ") +
             number_text(one.upper);
  return words;
}

struct Ranges {
  std::optional<Interval> numbers;  // range of numbers; for a rotation, of the numbers of its axis
  std::optional<Interval> angle;    // for a rotation, range of its angle
  std::string_view alternative;     // special value outside the range: "-1,-1,-1"
};
Ranges ranges_of(std::string_view text) {
  Ranges ranges;
  ranges.numbers = take_interval(text);
  if (text.starts_with(',')) {
    text.remove_prefix(1);
    ranges.angle = take_interval(text);
  }
  constexpr std::string_view kOr = " or ";
  if (text.starts_with(kOr)) ranges.alternative = text.substr(kOr.size());
  return ranges;
}

// Returns a message if a number is not finite or out of range, else nullopt.
std::optional<std::string> why_not(double number, const std::optional<Interval>& range) {
  if (!std::isfinite(number)) return "expected finite numbers";
  if (range && !range->has(number)) return number_text(number) + " is out of range; expected " + range_words(*range);
  return std::nullopt;
}

template <vrml::NumberElement T>
std::optional<std::string> why_not_all(const T& element, const std::optional<Interval>& range) {
  for (int i = 0; i < vrml::ElementNumbers<T>::kCount; ++i)
    if (auto why = why_not(vrml::numbers_of(element)[i], range)) return why;
  return std::nullopt;
}

constexpr Interval kUnitInterval{0, 1, false, false};

struct Check {
  Ranges ranges;

  template <vrml::NumberElement T>
  std::optional<std::string> operator()(const T& element) const {
    return why_not_all(element, ranges.numbers);
  }
  template <class T, int kInitial>
  std::optional<std::string> operator()(const Boxed<T, kInitial>& value) const {
    return (*this)(*value);
  }
  std::optional<std::string> operator()(const vrml::Color& color) const { return why_not_all(color, kUnitInterval); }
  std::optional<std::string> operator()(const vrml::ColorRGBA& color) const {
    return why_not_all(color, kUnitInterval);
  }
  std::optional<std::string> operator()(const glm::vec3& vector) const {
    if (ranges.alternative == "-1,-1,-1" && vector == glm::vec3(-1)) return std::nullopt;
    auto why = why_not_all(vector, ranges.numbers);
    if (why && !ranges.alternative.empty()) *why += ", or " + std::string(ranges.alternative);
    return why;
  }
  std::optional<std::string> operator()(const vrml::Rotation& rotation) const {
    if (auto why = why_not_all(glm::vec3(rotation.x, rotation.y, rotation.z), std::nullopt)) return why;
    if (rotation.x == 0 && rotation.y == 0 && rotation.z == 0 && rotation.angle != 0)
      return "0 0 0 is not an axis; expected the direction of the axis";
    return why_not(rotation.angle, ranges.angle);
  }
  template <class T>
  std::optional<std::string> operator()(const Array<T>& list) const {
    if constexpr (requires(T one) { (*this)(one); })
      for (std::size_t i = 0; i < list.size(); ++i)
        if (auto why = (*this)(list[i])) return "element " + std::to_string(i + 1) + ": " + *why;
    return std::nullopt;
  }
  std::optional<std::string> operator()(bool) const { return std::nullopt; }
  std::optional<std::string> operator()(vrml::NodeId) const { return std::nullopt; }
  std::optional<std::string> operator()(const vrml::String&) const { return std::nullopt; }
  std::optional<std::string> operator()(const vrml::PixelImage&) const { return std::nullopt; }
};

// Returns the declaration with the range. For an eventIn set_x, that is the field x.
const vrml::InterfaceDeclaration& with_range(const vrml::NodeType& type, const vrml::InterfaceDeclaration& event_in) {
  if (event_in.access != AccessType::eventIn || !event_in.name.starts_with("set_")) return event_in;
  const vrml::InterfaceDeclaration* const field = type.find_field(event_in.name.substr(4));
  return field && field->type == event_in.type ? *field : event_in;
}

}  // namespace

const vrml::InterfaceDeclaration* setter_of(const vrml::NodeType& type, const vrml::InterfaceDeclaration& field) {
  if (field.access == AccessType::exposedField || field.access == AccessType::eventIn) return &field;
  if (field.access != AccessType::field) return nullptr;
  const vrml::InterfaceDeclaration* const setter = type.find("set_" + field.name);
  return setter && setter->access == AccessType::eventIn && setter->type == field.type ? setter : nullptr;
}

const vrml::InterfaceDeclaration* field_set_by(const vrml::NodeType& type, const vrml::InterfaceDeclaration& event_in) {
  if (event_in.access == AccessType::exposedField) return &event_in;
  if (type.kind != vrml::NodeType::Kind::built_in || !event_in.name.starts_with("set_")) return nullptr;
  const vrml::InterfaceDeclaration* const field = type.find_field(event_in.name.substr(4));
  return field && setter_of(type, *field) == &event_in ? field : nullptr;
}

std::string why_not_set(const vrml::InterfaceDeclaration& field) {
  return field.access == AccessType::eventOut ? "eventOut: sent by the node only"
                                              : "field: fixed by the file, without an eventIn";
}

std::optional<std::string> why_not_valid(const vrml::NodeType& type, const vrml::InterfaceDeclaration& event_in,
                                         const vrml::FieldValue& value) {
  if (vrml::type_of(value) != event_in.type)
    return "expected a value of type " + std::string(vrml::name_of(event_in.type));
  return std::visit(Check{ranges_of(with_range(type, event_in).range)}, value);
}

std::variant<vrml::FieldValue, std::string> read_edit(const vrml::NodeType& type,
                                                      const vrml::InterfaceDeclaration& event_in,
                                                      const std::string& text, vrml::NodeNames& names) {
  auto value = read_value(text, event_in.type, names);
  if (!value)
    return vrml::holds_nodes(event_in.type)
               ? "expected DEF names, or Type#number, or NULL"
               : "'" + text.substr(0, 80) + "' is no " + std::string(vrml::name_of(event_in.type));
  if (auto why = why_not_valid(type, event_in, *value)) return std::move(*why);
  return std::move(*value);
}

}  // namespace gs::app
