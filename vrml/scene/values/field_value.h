#pragma once

#include "base/array.h"
#include "base/boxed.h"

#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <new>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>

namespace gs::vrml {

/// UTF-8 text of an SFString. Copies share storage.
class String {
 public:
  String() = default;
  String(std::string_view text) : bytes_(std::span<const char>(text.data(), text.size())) {}
  String(const char* text) : String(std::string_view(text)) {}
  String(const std::string& text) : String(std::string_view(text)) {}

  [[nodiscard]] std::string_view view() const { return {bytes_.data(), bytes_.size()}; }
  [[nodiscard]] std::string str() const { return std::string(view()); }
  [[nodiscard]] bool empty() const { return bytes_.empty(); }
  friend bool operator==(const String& a, const String& b) { return a.bytes_ == b.bytes_; }

 private:
  Array<char> bytes_;
};

/// Red, green and blue, each 0..1, in display space (VRML97 5.3).
struct Color {
  float r = 0, g = 0, b = 0;
  friend bool operator==(const Color&, const Color&) = default;
};

/// Red, green, blue and alpha, each 0..1, in display space (X3D 5.3.3).
struct ColorRGBA {
  float r = 0, g = 0, b = 0, a = 0;
  friend bool operator==(const ColorRGBA&, const ColorRGBA&) = default;
};

/// Number in double precision. A type of its own, because SFTime is `double` and the types of FieldValue must differ.
struct Double {
  double value = 0;
  operator double() const { return value; }
  friend bool operator==(const Double&, const Double&) = default;
};

/// Rotation about an axis, which need not be a unit vector. The angle is in radians, right-handed (VRML97 5.8).
struct Rotation {
  float x = 0, y = 0, z = 1, angle = 0;
  friend bool operator==(const Rotation&, const Rotation&) = default;
};

/// Value of an SFImage (VRML97 5.5): width, height, components (0..4), then one word per pixel from the lower left. The
/// first component of a pixel is in the highest used byte. The array is the same as in the file, so that a value is one
/// pointer.
struct PixelImage {
  Array<std::uint32_t> words;  // empty, or 3 + width * height words

  [[nodiscard]] std::uint32_t width() const { return words.empty() ? 0 : words[0]; }
  [[nodiscard]] std::uint32_t height() const { return words.empty() ? 0 : words[1]; }
  [[nodiscard]] std::uint32_t components() const { return words.empty() ? 0 : words[2]; }
  [[nodiscard]] std::span<const std::uint32_t> pixels() const {
    return words.size() > 3 ? words.span().subspan(3) : std::span<const std::uint32_t>{};
  }
  friend bool operator==(const PixelImage& a, const PixelImage& b) { return a.words == b.words; }
};

/// Identifier of a node: its index in the arena of a SceneGraph, and a generation that is unique in the world.
/// Therefore an id stays unique in the whole world, with Inlines and run-time nodes, even if the index is used again.
/// {0, 0} is NULL. Only the SceneGraph that created the node can look it up.
struct NodeId {
  std::uint32_t index = 0;
  std::uint32_t generation = 0;
  [[nodiscard]] explicit operator bool() const { return index != 0; }
  friend bool operator==(const NodeId&, const NodeId&) = default;
};

/// Field types of VRML97 clause 5 and X3D (ISO/IEC 19775-1 clause 5), in the order of the alternatives of FieldValue.
/// All SF types come before the MF types, and MFx follows SFx by kSingleTypeCount.
enum class FieldType : std::uint8_t {
  SFBool,
  SFColor,
  SFColorRGBA,
  SFDouble,
  SFFloat,
  SFImage,
  SFInt32,
  SFMatrix3d,
  SFMatrix3f,
  SFMatrix4d,
  SFMatrix4f,
  SFNode,
  SFRotation,
  SFString,
  SFTime,
  SFVec2d,
  SFVec2f,
  SFVec3d,
  SFVec3f,
  SFVec4d,
  SFVec4f,
  MFBool,
  MFColor,
  MFColorRGBA,
  MFDouble,
  MFFloat,
  MFImage,
  MFInt32,
  MFMatrix3d,
  MFMatrix3f,
  MFMatrix4d,
  MFMatrix4f,
  MFNode,
  MFRotation,
  MFString,
  MFTime,
  MFVec2d,
  MFVec2f,
  MFVec3d,
  MFVec3f,
  MFVec4d,
  MFVec4f,
};
inline constexpr int kSingleTypeCount = 21, kFieldTypeCount = 2 * kSingleTypeCount;

using SFBool = bool;
using SFColor = Color;
using SFColorRGBA = ColorRGBA;
using SFDouble = Double;
using SFFloat = float;
using SFImage = PixelImage;
using SFInt32 = std::int32_t;
// Matrices have the order of numbers of the file. There they are rows for row vectors; in glm, columns for column
// vectors.
using SFMatrix3d = Boxed<glm::dmat3, 1>;
using SFMatrix3f = Boxed<glm::mat3, 1>;
using SFMatrix4d = Boxed<glm::dmat4, 1>;
using SFMatrix4f = Boxed<glm::mat4, 1>;
using SFNode = NodeId;
using SFRotation = Rotation;
using SFString = String;
using SFTime = double;  // seconds since 1970-01-01 00:00 GMT
using SFVec2d = glm::dvec2;
using SFVec2f = glm::vec2;
using SFVec3d = Boxed<glm::dvec3, 0>;
using SFVec3f = glm::vec3;
using SFVec4d = Boxed<glm::dvec4, 0>;
using SFVec4f = glm::vec4;
using MFBool = Array<SFBool>;
using MFColor = Array<SFColor>;
using MFColorRGBA = Array<SFColorRGBA>;
using MFDouble = Array<SFDouble>;
using MFFloat = Array<SFFloat>;
using MFImage = Array<SFImage>;
using MFInt32 = Array<SFInt32>;
using MFMatrix3d = Array<glm::dmat3>;
using MFMatrix3f = Array<glm::mat3>;
using MFMatrix4d = Array<glm::dmat4>;
using MFMatrix4f = Array<glm::mat4>;
using MFNode = Array<SFNode>;
using MFRotation = Array<SFRotation>;
using MFString = Array<SFString>;
using MFTime = Array<SFTime>;
using MFVec2d = Array<SFVec2d>;
using MFVec2f = Array<SFVec2f>;
using MFVec3d = Array<glm::dvec3>;
using MFVec3f = Array<SFVec3f>;
using MFVec4d = Array<glm::dvec4>;
using MFVec4f = Array<SFVec4f>;

/// Value of any field type. `index()` is its FieldType. Values of more than 16 bytes are boxed.
using FieldValue = std::variant<SFBool, SFColor, SFColorRGBA, SFDouble, SFFloat, SFImage, SFInt32, SFMatrix3d,
                                SFMatrix3f, SFMatrix4d, SFMatrix4f, SFNode, SFRotation, SFString, SFTime, SFVec2d,
                                SFVec2f, SFVec3d, SFVec3f, SFVec4d, SFVec4f, MFBool, MFColor, MFColorRGBA, MFDouble,
                                MFFloat, MFImage, MFInt32, MFMatrix3d, MFMatrix3f, MFMatrix4d, MFMatrix4f, MFNode,
                                MFRotation, MFString, MFTime, MFVec2d, MFVec2f, MFVec3d, MFVec3f, MFVec4d, MFVec4f>;
static_assert(std::variant_size_v<FieldValue> == kFieldTypeCount);
static_assert(sizeof(FieldValue) == 24, "scenes have millions of values");

[[nodiscard]] inline FieldType type_of(const FieldValue& value) { return static_cast<FieldType>(value.index()); }
/// Returns the number of elements of an MF value, else 1.
[[nodiscard]] std::size_t element_count(const FieldValue& value);
[[nodiscard]] constexpr bool is_multiple(FieldType type) { return type >= FieldType::MFBool; }
/// Returns the type of the elements of an MF type. Returns an SF type unchanged.
[[nodiscard]] constexpr FieldType element_type(FieldType type) {
  return is_multiple(type) ? static_cast<FieldType>(static_cast<int>(type) - kSingleTypeCount) : type;
}
[[nodiscard]] constexpr bool holds_nodes(FieldType type) {
  return type == FieldType::SFNode || type == FieldType::MFNode;
}

/// Reports whether the bytes of the value are a copy of it: it owns no memory.
[[nodiscard]] inline bool owns_nothing(const FieldValue& value) {
  static constexpr auto kTrivial = []<std::size_t... i>(std::index_sequence<i...>) {
    static_assert(((std::is_trivially_copyable_v<std::variant_alternative_t<i, FieldValue>> ||
                    sizeof(std::variant_alternative_t<i, FieldValue>) == sizeof(void*)) &&
                   ...));
    return std::array{std::is_trivially_copyable_v<std::variant_alternative_t<i, FieldValue>>...};
  }
  (std::make_index_sequence<kFieldTypeCount>());
  // The other values are one pointer, which may be null.
  std::uintptr_t pointer = 0;
  std::memcpy(&pointer, static_cast<const void*>(&value), sizeof pointer);
  return kTrivial[value.index()] || pointer == 0;
}
/// Makes a copy of a value in uninitialized memory. Most values of scenes own nothing, and copying their bytes is
/// several times faster than finding their type.
inline void construct_copy(const FieldValue& value, FieldValue* at) {
  if (owns_nothing(value))
    std::memcpy(static_cast<void*>(at), static_cast<const void*>(&value), sizeof value);
  else
    new (at) FieldValue(value);
}
/// Assigns a value, with the same measure.
inline void assign(const FieldValue& value, FieldValue& to) {
  if (owns_nothing(to))
    construct_copy(value, &to);
  else
    to = value;
}

/// Returns the name of a field type: "SFBool", "MFVec3f", ...
[[nodiscard]] std::string_view name_of(FieldType type);
[[nodiscard]] std::optional<FieldType> field_type_named(std::string_view name);

/// Returns the value of a field without an explicit default: zero, FALSE, empty or NULL; 0 0 1 0 for SFRotation; the
/// identity for matrices.
[[nodiscard]] FieldValue initial_value(FieldType type);

}  // namespace gs::vrml
