#pragma once

#include "app/formats/volume/volume_common.h"
#include "base/budget.h"

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace gs::app {

/// Field of the points of a PCD file.
struct PcdField {
  std::string name;
  std::size_t size = 4;    // bytes of a number
  char type = 'F';         // F, I or U
  std::size_t count = 1;   // numbers of a point
  std::size_t offset = 0;  // of the field in the bytes of a point
  std::size_t column = 0;  // of its first number in text
};

/// Points of a PCD file: https://pointclouds.org/documentation/tutorials/pcd_file_format.html
class PcdCloud {
 public:
  /// Reads a file as text, bytes or compressed bytes. Returns a message on failure. Safe for untrusted bytes.
  [[nodiscard]] static std::variant<PcdCloud, std::string> open(std::span<const std::byte> bytes,
                                                                const WorldBudget& budget);
  /// Reads only the header. Returns false if it is damaged.
  [[nodiscard]] bool read_header(std::span<const std::byte> bytes);

  /// Returns the field with a name, or null.
  [[nodiscard]] const PcdField* field(std::string_view name) const;
  [[nodiscard]] const std::vector<PcdField>& fields() const { return fields_; }
  [[nodiscard]] std::size_t rows() const { return rows_; }
  [[nodiscard]] std::uint64_t announced() const { return announced_; }
  /// Returns the first number of a field of a point.
  [[nodiscard]] double number(const PcdField& field, std::size_t row) const;
  /// Returns the 32 bits of a packed colour of a point.
  [[nodiscard]] std::uint32_t packed(const PcdField& field, std::size_t row) const;
  /// Returns the position of a point, in the frame of the world if the file states the pose of the sensor. Points of an
  /// image (HEIGHT above 1) have the axes right, down, forward, and are turned upright.
  [[nodiscard]] glm::dvec3 position(std::size_t row) const;
  /// Turns a direction as position() does.
  [[nodiscard]] glm::dvec3 turned(const glm::dvec3& direction) const { return turn_ * direction; }
  /// Returns red, green and blue, 0 to 255, of a point.
  [[nodiscard]] static std::array<std::uint8_t, 3> rgb_of(std::uint32_t packed) {
    return {static_cast<std::uint8_t>(packed >> 16), static_cast<std::uint8_t>(packed >> 8),
            static_cast<std::uint8_t>(packed)};
  }

 private:
  [[nodiscard]] std::string read_points(std::span<const std::byte> bytes, const WorldBudget& budget);
  [[nodiscard]] std::string read_text(std::span<const std::byte> bytes, const WorldBudget& budget);
  [[nodiscard]] std::string unpack(std::span<const std::byte> bytes, const WorldBudget& budget);
  [[nodiscard]] const std::byte* place(const PcdField& field, std::size_t row) const;

  enum class Form : std::uint8_t { text, binary, compressed };

  std::vector<PcdField> fields_;
  std::uint64_t width_ = 0, height_ = 1, announced_ = 0;
  Form form_ = Form::text;
  std::size_t data_ = 0;               // offset of the points in the file
  std::array<std::size_t, 3> axes_{};  // indices of x, y and z in `fields_`
  std::size_t point_bytes_ = 0, columns_ = 0, rows_ = 0;
  glm::dmat3 turn_{1};
  glm::dvec3 shift_{0};
  std::span<const std::byte> stored_;
  std::vector<std::byte> unpacked_;
  std::vector<double> numbers_;  // of text, point by point
  Share share_;
};

/// Unpacks LZF data, which must fill `to`. Returns false if they do not.
[[nodiscard]] bool unpack_lzf(std::span<const std::byte> from, std::span<std::byte> to);

}  // namespace gs::app
