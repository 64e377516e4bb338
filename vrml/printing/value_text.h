#pragma once

#include "vrml/printing/text_output.h"
#include "vrml/scene/values/field_numbers.h"
#include "vrml/scene/values/field_value.h"

#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>

// Texts of field values without nodes.
namespace gs::vrml {

/// Notation of values: VRML97 and classic X3D, attributes in XML, JSON.
enum class Notation : std::uint8_t { classic, xml, json };

inline constexpr std::size_t kLineWidth = 100;

/// Appends the shortest text that gives the same number. JSON has no infinite numbers; they become the largest one.
/// Omits the sign of NaN, which differs between processors.
template <Notation kNotation, class Number>
void append_number(std::string& out, Number number) {
  if constexpr (kNotation == Notation::json && std::is_floating_point_v<Number>)
    if (!std::isfinite(number))
      number = std::isnan(number) ? Number{0} : std::copysign(std::numeric_limits<Number>::max(), number);
  if constexpr (std::is_floating_point_v<Number>)
    if (std::isnan(number)) number = std::numeric_limits<Number>::quiet_NaN();
  char digits[64];
  const auto result = std::to_chars(digits, digits + sizeof digits, number);
  out.append(digits, result.ptr);
}

/// Appends text between quotes of VRML97 (5.12).
void append_quoted(std::string& out, std::string_view text);
/// Appends the text of an SFString in an attribute. Doubles backslashes that readers would take for an escape.
void append_unquoted(std::string& out, std::string_view text);
/// Appends the text of an attribute in apostrophes. Omits characters that XML does not allow.
void append_xml(std::string& out, std::string_view text);
/// Appends a JSON string with its quotes. Broken UTF-8 becomes U+FFFD.
void append_json(std::string& out, std::string_view text);
/// Reports whether XML can express the text (XML 1.0 2.2): it has no control characters and no broken UTF-8.
[[nodiscard]] bool is_xml_text(std::string_view text);

/// Appends the text of an SFString, or of an element of an MFString.
template <Notation kNotation>
void append_string(std::string& out, std::string_view text, bool in_list) {
  if constexpr (kNotation == Notation::json) {
    append_json(out, text);
  } else if constexpr (kNotation == Notation::xml) {
    std::string quoted;
    in_list ? append_quoted(quoted, text) : append_unquoted(quoted, text);
    append_xml(out, quoted);
  } else {
    append_quoted(out, text);
  }
}

/// Appends the words of a PixelImage.
template <Notation kNotation>
void append_image(TextOutput& output, const PixelImage& image) {
  constexpr std::string_view kBetween = kNotation == Notation::json ? "," : " ";
  std::string& out = output.text;
  append_number<kNotation>(out, image.width());
  append_number<kNotation>(out += kBetween, image.height());
  append_number<kNotation>(out += kBetween, image.components());
  // Readers of other formats may leave bits beyond those of the components.
  const std::uint32_t unused = image.components() < 4 ? ~std::uint32_t{0} << 8 * image.components() : 0;
  for (const std::uint32_t given : image.pixels()) {
    const std::uint32_t pixel = given & ~unused;
    out += kBetween;
    if constexpr (kNotation == Notation::json) {
      append_number<kNotation>(out, pixel);
    } else {
      char digits[16];
      const auto result = std::to_chars(digits, digits + sizeof digits, pixel, 16);
      out += "0x";
      out.append(digits, result.ptr);
    }
    output.drain();
  }
}

/// Appends one element of a value: a number, a vector, a string, ...
template <Notation kNotation, class T>
void append_element(TextOutput& output, const T& element, bool in_list) {
  std::string& out = output.text;
  if constexpr (std::is_same_v<T, SFBool>) {
    out += kNotation == Notation::classic ? (element ? "TRUE" : "FALSE") : (element ? "true" : "false");
  } else if constexpr (std::is_same_v<T, SFString>) {
    append_string<kNotation>(out, element.view(), in_list);
  } else if constexpr (std::is_same_v<T, SFImage>) {
    append_image<kNotation>(output, element);
  } else if constexpr (NumberElement<T>) {
    const auto* const numbers = numbers_of(element);
    append_number<kNotation>(out, numbers[0]);
    for (int i = 1; i < ElementNumbers<T>::kCount; ++i)
      append_number<kNotation>(out += kNotation == Notation::json ? ',' : ' ', numbers[i]);
  }
}

/// Appends the elements of a list, in lines of readable length. `levels` is the indentation of further lines. Returns
/// true if the list has several lines.
template <Notation kNotation, class T>
bool append_elements(TextOutput& output, const Array<T>& list, std::size_t line_start, std::size_t levels) {
  constexpr bool kSpaced = ElementNumbers<T>::kCount != 1 && !std::is_same_v<T, SFBool>;
  constexpr std::string_view kBetween = kSpaced ? ", " : kNotation == Notation::json ? "," : " ";
  std::string& out = output.text;
  std::string element;
  bool broken = false;
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (i > 0) out += kBetween;
    const std::size_t start = out.size();
    append_element<kNotation, T>(output, list[i], true);
    if constexpr (std::is_same_v<T, SFImage>) continue;
    if (i == 0 || out.size() - line_start <= kLineWidth) continue;
    element.assign(out, start);
    out.resize(start);
    while (out.back() == ' ') out.pop_back();
    output.drain();
    output.start_line(levels);
    line_start = out.size();
    out += element;
    broken = true;
  }
  return broken;
}

/// Appends a value without nodes. `levels` is the indentation of the line with the value.
template <Notation kNotation>
void append_value(TextOutput& output, const FieldValue& value, std::size_t levels) {
  std::visit(
      [&](const auto& v) {
        using T = std::decay_t<decltype(v)>;
        std::string& out = output.text;
        if constexpr (std::is_same_v<T, SFNode> || std::is_same_v<T, MFNode>) {
          return;
        } else if constexpr (requires { v.span(); }) {
          const std::size_t start = out.size();
          if constexpr (kNotation == Notation::xml) {
            append_elements<kNotation>(output, v, start, levels + 1);
          } else {
            constexpr bool kClassic = kNotation == Notation::classic;
            if (v.empty()) {
              out += "[]";
              return;
            }
            out += kClassic ? "[ " : "[";
            if (append_elements<kNotation>(output, v, start, levels + 1)) {
              output.start_line(levels);
              out += ']';
            } else {
              out += kClassic ? " ]" : "]";
            }
          }
        } else {
          using Element = ElementOf<T>;
          constexpr bool kListed =
              kNotation == Notation::json && (ElementNumbers<Element>::kCount > 1 || std::is_same_v<T, SFImage>);
          if (kListed) out += '[';
          append_element<kNotation, Element>(output, element_in(v), false);
          if (kListed) out += ']';
        }
      },
      value);
}

}  // namespace gs::vrml
