// Measures whether borders of bricks stand out in volumes that are larger than memory.
//
//   brick_seams STREAM [STREAM ...]
//
// A view from each corner decodes each prefix of a stream into bricks of several levels. At the faces where a brick
// lies beside a coarser part, the program compares neighbouring voxels of the coarser lattice: across the face, one
// step inside of the brick, and one step inside of the coarser part. It does the same at faces between bricks of one
// level. Prints a Markdown table of mean absolute differences. The last column is the ratio across / mean of both
// insides, divided by that of the volume itself at the same places: 1 means that the border does not stand out.
#include "net/files/file.h"
#include "qnv/codecs/values/bricks/brick_volume.h"
#include "qnv/codecs/values/decode/values_decoder.h"
#include "qnv/sampling/volume/volume_values.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <variant>
#include <vector>

namespace {

using namespace gs;
using qnv::values::Extent;
using Bytes = std::vector<std::byte>;

constexpr std::array<std::size_t, 10> kPrefixes{4000,   8000,   15000,  30000,   60000,
                                                125000, 250000, 500000, 1000000, ~std::size_t{0}};
constexpr std::size_t kBasePart = 60;  // samples of the volume per sample of the coarse level

/// Sums of absolute differences of pairs of voxels.
struct Differences {
  double across = 0, fine = 0, coarse = 0, count = 0;
  [[nodiscard]] double ratio() const { return fine + coarse > 0 ? 2 * across / (fine + coarse) : 0; }
};

/// Decoded values of a view: bricks by level and place, and the coarse level.
class Shown {
 public:
  explicit Shown(std::shared_ptr<const qnv::Volume> volume) : volume_(std::move(volume)) {
    if (!volume_ || !volume_->values) return;
    const qnv::VolumeValues& values = *volume_->values;
    base_ = values.level;
    extent_ = values.source.layout.dimensions;
    samples_.resize(qnv::values::sample_count(extent_));
    const std::size_t slice = std::size_t{extent_[0]} * extent_[1];
    for (std::uint32_t z = 0; z < extent_[2]; ++z)
      (void)values.source.read(z, std::as_writable_bytes(std::span(samples_).subspan(z * slice, slice)));
    for (const qnv::ValueBrick& brick : values.bricks)
      bricks_[{brick.level, brick.core_first[0] / 64, brick.core_first[1] / 64, brick.core_first[2] / 64}] = &brick;
  }

  [[nodiscard]] int base() const { return base_; }
  [[nodiscard]] const std::vector<qnv::ValueBrick>& bricks() const { return volume_->values->bricks; }
  /// Returns the finest level that has the voxel at a place of the whole volume, from `level` on.
  [[nodiscard]] int level_at(const Extent& place, int level) const {
    while (level < base_ && !brick_at(place, level)) ++level;
    return level;
  }
  /// Returns the value of `level` at a place of the whole volume, which is a multiple of its step.
  [[nodiscard]] std::optional<double> value(const Extent& place, int level) const {
    const Extent at{place[0] >> level, place[1] >> level, place[2] >> level};
    if (level < base_) {
      const qnv::ValueBrick* const brick = brick_at(place, level);
      if (!brick) return std::nullopt;
      const float number = brick->value(at[0], at[1], at[2]);
      return number == number ? std::optional<double>(number) : std::nullopt;
    }
    for (std::size_t a = 0; a < 3; ++a)
      if (at[a] >= extent_[a]) return std::nullopt;
    const qnv::VolumeLayout& layout = volume_->values->source.layout;
    return samples_[(std::size_t{at[2]} * extent_[1] + at[1]) * extent_[0] + at[0]] * layout.slope + layout.intercept;
  }

 private:
  using Key = std::tuple<int, std::uint32_t, std::uint32_t, std::uint32_t>;
  [[nodiscard]] const qnv::ValueBrick* brick_at(const Extent& place, int level) const {
    const auto found =
        bricks_.find({level, (place[0] >> level) / 64, (place[1] >> level) / 64, (place[2] >> level) / 64});
    return found != bricks_.end() ? found->second : nullptr;
  }

  std::shared_ptr<const qnv::Volume> volume_;
  int base_ = 0;
  Extent extent_{};
  std::vector<std::int32_t> samples_;
  std::map<Key, const qnv::ValueBrick*> bricks_;
};

std::shared_ptr<const qnv::Volume> shown_by(const std::shared_ptr<const qnv::ChunkSource>& source, const Extent& extent,
                                            const qnv::LodView& view) {
  qnv::BrickLimits limits;
  limits.base_vectors = qnv::values::sample_count(extent) / kBasePart / qnv::values::kSamplesPerVector;
  limits.brick_bytes = std::size_t{4} << 30;
  auto opened = qnv::BrickVolume::open(source, limits);
  if (!std::holds_alternative<std::shared_ptr<qnv::BrickVolume>>(opened)) return nullptr;
  bool pending = false;
  return std::get<0>(opened)->cut(view, pending);
}

// Adds the differences at one face of a brick. `upper` is the end of the axis.
void measure_face(const Shown& shown, const Shown& whole, const qnv::ValueBrick& brick, std::size_t axis, bool upper,
                  const Extent& extent, std::array<Differences, 2>& beside, std::array<Differences, 2>& source) {
  const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
  const std::uint32_t first = brick.core_first[axis], end = first + brick.core_size[axis];
  if (upper ? (std::uint64_t{end} << brick.level) >= extent[axis] : first == 0) return;
  for (std::uint32_t j = 0; j < brick.core_size[v]; ++j)
    for (std::uint32_t i = 0; i < brick.core_size[u]; ++i) {
      // Places of the whole volume: the neighbour outside, and steps away from the face.
      Extent outside{};
      outside[u] = (brick.core_first[u] + i) << brick.level;
      outside[v] = (brick.core_first[v] + j) << brick.level;
      outside[axis] = (upper ? end : first - 1) << brick.level;
      const int level = shown.level_at(outside, brick.level);
      const std::uint32_t step = 1u << level;
      if (outside[u] % step != 0 || outside[v] % step != 0) continue;
      const std::uint32_t face = (upper ? end : first) << brick.level;
      Extent places[4];  // coarse inside, coarse, fine, fine inside
      bool whole_line = true;
      for (int k = 0; k < 4; ++k) {
        // The face of a brick is at a multiple of all steps. The lower part begins below it.
        const std::int64_t at = upper ? std::int64_t{face} + (1 - k) * std::int64_t{step}
                                      : std::int64_t{face} + (k - 2) * std::int64_t{step};
        places[k] = outside;
        whole_line = whole_line && at >= 0 && at < extent[axis];
        places[k][axis] = static_cast<std::uint32_t>(std::max<std::int64_t>(at, 0));
      }
      if (!whole_line) continue;
      const auto add = [&](const Shown& from, bool finest, Differences& to) {
        std::array<double, 4> values{};
        for (int k = 0; k < 4; ++k) {
          const auto value = from.value(places[k], finest ? 0 : k < 2 ? level : brick.level);
          if (!value) return;
          values[static_cast<std::size_t>(k)] = *value;
        }
        to.coarse += std::abs(values[0] - values[1]);
        to.across += std::abs(values[1] - values[2]);
        to.fine += std::abs(values[2] - values[3]);
        ++to.count;
      };
      const std::size_t kind = level > brick.level ? 1 : 0;
      add(shown, false, beside[kind]);
      add(whole, true, source[kind]);
    }
}

int measure(const std::string& path) {
  const auto mapped = net::map_file(path);
  const auto* const file = std::get_if<net::MappedFile>(&mapped);
  if (!file) return 1;
  const Bytes stream(file->bytes().begin(), file->bytes().end());
  const auto complete = qnv::memory_source(stream);
  std::size_t header_bytes = 0;
  const auto header = qnv::read_stream_header(*complete, header_bytes);
  const auto* const known = std::get_if<qnv::StreamHeader>(&header);
  if (!known || known->payload != qnv::Payload::values) return 1;
  const Extent extent = known->grid.dimensions;
  qnv::LodView everything;
  everything.eye = known->description.box.lower - glm::vec3(1000);
  everything.pixels = 1e9f;
  // A slice along each axis lets parts without vectors have bricks, too.
  const glm::vec3 middle = (known->description.box.lower + known->description.box.upper) * 0.5f;
  for (int a = 0; a < 3; ++a) {
    everything.volume.slices[static_cast<std::size_t>(a)][a] = 1;
    everything.volume.slices[static_cast<std::size_t>(a)].w = -middle[a];
  }
  const Shown whole(shown_by(complete, extent, everything));
  const Box& box = known->description.box;
  qnv::LodView corner = everything;
  corner.pixels = 1.2f * (box.upper.x - box.lower.x);
  corner.error_pixels = 2.5f;
  std::printf(
      "\n%s\n\n| bytes | pairs | inside, fine | inside, coarse | across | relative to the volume | one level: across | "
      "relative |\n|---:|---:|---:|---:|---:|---:|---:|---:|\n",
      path.c_str());
  for (const std::size_t size : kPrefixes) {
    const std::size_t bytes = std::min(size, stream.size());
    const auto prefix = qnv::memory_source(Bytes(stream.begin(), stream.begin() + static_cast<std::ptrdiff_t>(bytes)));
    std::array<Differences, 2> beside{}, source{};
    for (unsigned c = 0; c < 8; ++c) {
      for (int a = 0; a < 3; ++a) corner.eye[a] = (c >> a & 1) != 0 ? box.upper[a] : box.lower[a];
      const Shown shown(shown_by(prefix, extent, corner));
      for (const qnv::ValueBrick& brick : shown.bricks())
        for (std::size_t axis = 0; axis < 3; ++axis)
          for (const bool upper : {false, true}) measure_face(shown, whole, brick, axis, upper, extent, beside, source);
    }
    const Differences& mixed = beside[1];
    const double n = std::max(mixed.count, 1.0), m = std::max(beside[0].count, 1.0);
    const auto relative = [&](std::size_t kind) {
      return source[kind].ratio() > 0 ? beside[kind].ratio() / source[kind].ratio() : 0.0;
    };
    std::printf("| %zu | %.0f | %.1f | %.1f | %.1f | %.2f | %.1f | %.2f |\n", bytes, mixed.count, mixed.fine / n,
                mixed.coarse / n, mixed.across / n, relative(1), beside[0].across / m, relative(0));
    if (bytes == stream.size()) break;
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: brick_seams STREAM [STREAM ...]\n");
    return 2;
  }
  for (int i = 1; i < argc; ++i)
    if (const int status = measure(argv[i])) {
      std::fprintf(stderr, "brick_seams: %s: expected a values stream\n", argv[i]);
      return status;
    }
  return 0;
}
