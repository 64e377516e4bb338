#include "qnv/codecs/values/encode/color_components.h"

#include "qnv/codecs/values/encode/encode_values.h"
#include "qnv/sampling/volume/color_voxels.h"
#include "qnv/sampling/volume/volume_slices.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <utility>

namespace gs::qnv::values {
namespace {

// Box in the middle of a volume that is encoded in both forms, to measure their bytes.
constexpr Extent kMeasured{96, 96, 48};

using Planes = std::array<std::vector<std::byte>, 3>;

/// Permitted errors of brightness and of differences that keep the error of each colour within a limit. A difference
/// counts half, rounded up.
struct LumaErrors {
  int brightness = 0, difference = 0;
};
LumaErrors luma_errors(int error) { return {error - error / 4 * 2, error / 4 * 2}; }

int permitted_error(const ValueTolerance& tolerance) {
  if (tolerance.lossless || !tolerance.error) return 0;
  return static_cast<int>(std::clamp(*tolerance.error * (tolerance.of_range ? 255 : 1) + 1e-9, 0.0, 255.0));
}

// Returns the bytes of the samples of a box with a permitted error.
std::variant<std::size_t, EncodeError> bytes_of(const std::vector<std::int32_t>& samples, Extent extent, int error) {
  const std::size_t slice = std::size_t{extent[0]} * extent[1];
  const ReadSamples read = [&](std::uint32_t first, std::uint32_t count,
                               SampleBatch& batch) -> std::optional<EncodeError> {
    const auto begin = samples.begin() + static_cast<std::ptrdiff_t>(first * slice);
    batch.first = first;
    batch.count = count;
    batch.missing.clear();
    batch.samples.assign(begin, begin + static_cast<std::ptrdiff_t>(count * slice));
    return std::nullopt;
  };
  MemoryStore store;
  auto encoded = encode_values(read, extent, {static_cast<std::uint32_t>(error), 0}, store);
  if (auto* problem = std::get_if<EncodeError>(&encoded)) return std::move(*problem);
  std::size_t bytes = 0;
  for (const StoredCluster& cluster : std::get<EncodedValues>(encoded).clusters)
    bytes += cluster.bytes + kChunkHeaderBytes;
  for (const StoredRun& run : std::get<EncodedValues>(encoded).corrections) bytes += run.bytes + kChunkHeaderBytes;
  return bytes;
}

// Reads the colours of the measured box.
std::variant<std::array<std::vector<std::int32_t>, 3>, EncodeError> middle_of(const VolumeSource& source,
                                                                              Extent& extent) {
  const VolumeLayout& layout = source.components.front().layout;
  Extent first{};
  for (std::size_t a = 0; a < 3; ++a) {
    extent[a] = std::min(layout.dimensions[a], kMeasured[a]);
    first[a] = (layout.dimensions[a] - extent[a]) / 2;
  }
  std::array<std::vector<std::int32_t>, 3> samples;
  std::vector<std::byte> plane(slice_voxels(layout));
  for (std::uint32_t z = first[2]; z < first[2] + extent[2]; ++z)
    for (std::size_t c = 0; c < 3; ++c) {
      if (!source.components[c].read(z, plane))
        return EncodeError{"slice " + std::to_string(z) + " of the volume cannot be read"};
      for (std::size_t y = first[1]; y < first[1] + extent[1]; ++y)
        for (std::size_t x = first[0]; x < first[0] + extent[0]; ++x)
          samples[c].push_back(std::to_integer<std::int32_t>(plane[y * layout.dimensions[0] + x]));
    }
  return samples;
}

std::variant<bool, EncodeError> luma_is_smaller(const VolumeSource& source, int error) {
  Extent extent{};
  auto read = middle_of(source, extent);
  if (auto* problem = std::get_if<EncodeError>(&read)) return std::move(*problem);
  auto& samples = std::get<0>(read);
  const LumaErrors errors = luma_errors(error);
  std::array<std::size_t, 2> bytes{};
  for (const bool luma : {false, true}) {
    for (std::size_t i = 0; luma && i < samples[0].size(); ++i) {
      const LumaColor color = luma_of(samples[0][i], samples[1][i], samples[2][i]);
      samples[0][i] = color.y;
      samples[1][i] = color.orange;
      samples[2][i] = color.green;
    }
    for (std::size_t c = 0; c < 3; ++c) {
      const int permitted = !luma ? error : c == 0 ? errors.brightness : errors.difference;
      const auto one = bytes_of(samples[c], extent, permitted);
      if (const auto* problem = std::get_if<EncodeError>(&one)) return *problem;
      bytes[luma ? 1 : 0] += std::get<std::size_t>(one);
    }
  }
  return bytes[1] < bytes[0];
}

/// Brightness and differences of the slices of colours. Keeps the last slice. Any thread.
class LumaSlices {
 public:
  explicit LumaSlices(std::vector<VolumeSource> components) : components_(std::move(components)) {}

  bool read(std::size_t c, std::uint32_t z, std::span<std::byte> to) {
    const std::lock_guard lock(mutex_);
    const std::size_t slice = slice_voxels(components_.front().layout);
    if (to.size() != slice * sizeof(std::int16_t)) return false;
    if (!kept_ || z_ != z) {
      kept_ = false;
      for (std::size_t k = 0; k < 3; ++k) {
        planes_[k].resize(slice);
        if (!components_[k].read(z, planes_[k])) return false;
      }
      kept_ = true;
      z_ = z;
    }
    const auto color = [&](std::size_t i, std::size_t k) { return std::to_integer<std::int32_t>(planes_[k][i]); };
    for (std::size_t i = 0; i < slice; ++i) {
      const LumaColor luma = luma_of(color(i, 0), color(i, 1), color(i, 2));
      const auto number = static_cast<std::int16_t>(c == 0 ? luma.y : c == 1 ? luma.orange : luma.green);
      std::memcpy(to.data() + i * sizeof number, &number, sizeof number);
    }
    return true;
  }

 private:
  const std::vector<VolumeSource> components_;
  std::mutex mutex_;
  Planes planes_;
  std::uint32_t z_ = 0;
  bool kept_ = false;
};

}  // namespace

std::variant<ComponentPlan, EncodeError> plan_components(const VolumeSource& source, const ValueTolerance& tolerance,
                                                         std::optional<bool> luma) {
  ComponentPlan plan;
  if (source.components.empty()) {
    plan.components.push_back({source, tolerance, 0});
    return plan;
  }
  for (const VolumeSource& one : source.components) plan.components.push_back({one, tolerance, 0});
  plan.colors = has_colors(source);
  if (!plan.colors) return plan;
  const int error = permitted_error(tolerance);
  if (!luma) {
    const auto smaller = luma_is_smaller(source, error);
    if (const auto* problem = std::get_if<EncodeError>(&smaller)) return *problem;
    luma = std::get<bool>(smaller);
  }
  plan.luma = *luma;
  const LumaErrors errors = luma_errors(error);
  const auto slices = std::make_shared<LumaSlices>(source.components);
  // Sums of the squared errors of red, green and blue, for an error of 1.
  constexpr std::array<double, 3> kWeights{3, 0.5, 0.75};
  for (std::size_t c = 0; c < plan.components.size(); ++c) {
    PlannedComponent& one = plan.components[c];
    ValueTolerance& own = one.tolerance;
    own = {};
    own.lossless = error == 0;
    if (error > 0) own.error = error;
    if (!plan.luma || c >= kWeights.size()) continue;
    if (error > 0) own.error = c == 0 ? errors.brightness : errors.difference;
    one.weight = kWeights[c];
    one.source.layout.type = VoxelType::i16;
    one.source.layout.big_endian = std::endian::native == std::endian::big;
    one.source.read = [slices, c](std::uint32_t z, std::span<std::byte> to) { return slices->read(c, z, to); };
  }
  return plan;
}

}  // namespace gs::qnv::values
