#pragma once

#include "bench/studio.h"
#include "qnv/base/cloud.h"
#include "render/image/image.h"

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

namespace gs::bench {

/// How a part of a transfer becomes a picture.
enum class Prefix : std::uint8_t {
  stream,  // the first bytes of a QNV stream
  world,   // the first bytes of a world
  none     // only the whole file can be drawn
};

/// One way to send the model.
struct Format {
  std::string_view name;   // on the command line
  std::string_view title;  // in tables
  std::string_view file;   // that is sent
  Prefix prefix = Prefix::none;
  bool cells = false;      // by cells over UDP; else by HTTP
  bool one_range = false;  // asked for as one range of bytes, so that the server does not compress it on the way
};

/// All ways, in the order of the tables. Another one is a row here, and its file in Model::make.
inline constexpr std::array<Format, 9> kFormats{{
    {"records", "QNV records, HTTP", "records.qnv", Prefix::stream},
    {"packed", "QNV packed, HTTP", "packed.qnv", Prefix::stream},
    {"outlines", "Outline groups, HTTP", "outlines.qnv", Prefix::world},
    {"vrml", "VRML97, HTTP", "model.wrl", Prefix::world, false, true},
    {"gzip", "VRML97 gzip'd, HTTP", "model.wrl.gz", Prefix::world, false, true},
    {"draco", "Draco, HTTP", "model.drc", Prefix::none},
    {"cells-records", "QNV records, cells", "records.qnv", Prefix::stream, true},
    {"cells-packed", "QNV packed, cells", "packed.qnv", Prefix::stream, true},
    {"cells-outlines", "Outline groups, cells", "outlines.qnv", Prefix::world, true},
}};

/// Of kFormats; null for a name that is none.
[[nodiscard]] constexpr const Format* format_named(std::string_view name) {
  for (const Format& format : kFormats)
    if (format.name == name) return &format;
  return nullptr;
}

/// The SSIM of a usable picture.
inline constexpr double kUsable = 0.9;

struct ModelOptions {
  std::string file;              // of any type that opens as polygons; VRML97 is sent as it is
  std::string folder;            // for all generated files; exists and is empty
  View view;                     // of all pictures
  int draco_bits = 11;           // of a coordinate
  std::size_t packed_bytes = 0;  // 0: twice of what Draco's file has
  std::size_t record_vectors = 125'000;
  double tolerance = 0.005;  // of outline groups, of the model's diagonal
};

/// Visible result of a part of a transfer.
struct Shown {
  bool anything = false;  // one pixel that is no background
  PictureError error;     // beside the mesh itself
};

/// How many bytes of a file it takes.
struct Thresholds {
  std::uint64_t size = 0;
  std::optional<std::uint64_t> first, usable;  // to anything at all; to SSIM 0.9
  PictureError end;
};

/// A model in all formats, in a folder that can be served, and its picture. Keeps the studio. One thread.
class Model {
 public:
  [[nodiscard]] static std::variant<std::unique_ptr<Model>, std::string> make(const ModelOptions& options,
                                                                              Studio& studio);
  /// To be served.
  [[nodiscard]] std::string folder() const { return options_.folder + "/served"; }
  /// 0 where there is none: Draco's programs are missing.
  [[nodiscard]] std::uint64_t size(const Format& format) const;
  [[nodiscard]] std::size_t triangles() const { return triangles_; }
  /// Of the QNV streams.
  [[nodiscard]] std::size_t packed_vectors() const { return packed_vectors_; }
  [[nodiscard]] std::size_t record_vectors() const { return record_vectors_; }

  [[nodiscard]] std::size_t outline_groups() const { return outline_groups_; }

  [[nodiscard]] Shown show(const render::RenderList& list) { return compare(list); }
  /// The first bytes of the format's file. Nothing where it cannot be drawn.
  [[nodiscard]] std::optional<Shown> show(const Format& format, std::uint64_t bytes);
  [[nodiscard]] Thresholds thresholds(const Format& format);

 private:
  Model(const ModelOptions& options, Studio& studio) : options_(options), studio_(studio) {}
  [[nodiscard]] std::optional<std::string> make_world();
  [[nodiscard]] std::optional<std::string> make_streams(const render::RenderList& full);
  void take_draco(const std::string& base);
  [[nodiscard]] std::optional<std::string> make_outlines(const render::RenderList& full);
  [[nodiscard]] std::optional<Shown> show_world(const std::string& path, std::uint64_t bytes);
  [[nodiscard]] Shown compare(const render::RenderList& list);

  ModelOptions options_;
  Studio& studio_;
  float crease_angle_ = 0;
  render::WorldBounds bounds_;
  std::vector<render::Image> reference_;
  std::size_t triangles_ = 0, packed_vectors_ = 0, record_vectors_ = 0, outline_groups_ = 0;
};

/// The least number from `low` to `high` of which something is true that is true of all larger ones, or up to `step`
/// more. It is true of `high`.
template <class Holds>
[[nodiscard]] std::uint64_t least(std::uint64_t low, std::uint64_t high, std::uint64_t step, const Holds& holds) {
  while (low < high && high - low >= step) {
    const std::uint64_t middle = low + (high - low) / 2;
    if (holds(middle))
      high = middle;
    else
      low = middle + 1;
  }
  return high;
}

}  // namespace gs::bench
