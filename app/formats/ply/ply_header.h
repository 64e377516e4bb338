#pragma once

#include "app/formats/common/import_context.h"
#include "app/formats/common/text_cursor.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gs::app {

enum class PlyType : std::uint8_t { int8, uint8, int16, uint16, int32, uint32, float32, float64 };
[[nodiscard]] std::size_t size_of(PlyType type);
[[nodiscard]] inline bool is_float(PlyType type) { return type == PlyType::float32 || type == PlyType::float64; }

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::float32;
  bool is_list = false;
  PlyType count_type = PlyType::uint8;
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;

  [[nodiscard]] bool has_lists() const;
  /// Returns the minimum size of a row of a binary file, in bytes.
  [[nodiscard]] std::size_t least_row_bytes() const;
};

enum class PlyFormat : std::uint8_t { ascii, little_endian, big_endian };

struct PlyHeader {
  PlyFormat format = PlyFormat::ascii;
  std::vector<PlyElement> elements;
  std::string texture_file;  // "comment TextureFile NAME", as written by MeshLab and others
  bool antialiased = false;  // "comment SplatRenderMode: mip" (Brush) or "comment antialiased 1" (Postshot)
};

/// Reads the header up to and including the `end_header` line. If the header is invalid, reports an error and returns
/// nullopt.
[[nodiscard]] std::optional<PlyHeader> read_ply_header(TextCursor& cursor, ImportContext& context);

}  // namespace gs::app
