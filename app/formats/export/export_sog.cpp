#include "app/formats/archive/zip_writer.h"
#include "app/formats/export/export.h"
#include "app/formats/export/export_vectors.h"
#include "app/formats/export/sog_codebook.h"
#include "app/formats/splats/splats.h"
#include "base/box.h"
#include "base/parallel.h"
#include "qnv/base/morton.h"

#include <webp/encode.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <numeric>
#include <optional>
#include <utility>

// Export of PlayCanvas SOG, version 2: lossless images with one pixel per splat, in a ZIP archive.
namespace gs::app {
namespace {

using SogJson = nlohmann::ordered_json;

constexpr std::size_t kMostSogSide = 16383;  // pixels of a WebP image
constexpr std::size_t kSogPaletteUnit = 1024, kMostSogPalette = 65536, kSogCentersPerRow = 64;
constexpr std::size_t kMostSogBytes = (std::size_t{1} << 32) - (1 << 16);  // of a ZIP archive, beside its directory
constexpr float kLeastLogScale = -20, kMostLogScale = 40;
constexpr int kSogMethod = 4;         // of WebP: 0 is fast, 9 is small
constexpr float kMinSogSteps = 4096;  // as for SPZ: fewer steps would deform content that is far from 0

/// Image with four bytes a pixel. Alpha is 255 unless it carries data.
struct SogImage {
  SogImage(std::size_t across, std::size_t down) : width(across), height(down), rgba(4 * across * down, 255) {}
  [[nodiscard]] std::uint8_t* at(std::size_t i) { return rgba.data() + 4 * i; }

  std::size_t width, height;
  std::vector<std::uint8_t> rgba;
};

/// Returns an image as a lossless WebP file. Returns nullopt if there is not enough memory.
std::optional<std::vector<std::byte>> webp_of(const SogImage& image) {
  WebPConfig config;
  WebPPicture picture;
  if (!WebPConfigInit(&config) || !WebPPictureInit(&picture) || !WebPConfigLosslessPreset(&config, kSogMethod))
    return std::nullopt;
  config.exact = 1;  // keeps the colours of transparent pixels
  picture.use_argb = 1;
  picture.width = static_cast<int>(image.width);
  picture.height = static_cast<int>(image.height);
  WebPMemoryWriter writer;
  WebPMemoryWriterInit(&writer);
  picture.writer = WebPMemoryWrite;
  picture.custom_ptr = &writer;
  const bool good = WebPPictureImportRGBA(&picture, image.rgba.data(), static_cast<int>(4 * image.width)) != 0 &&
                    WebPEncode(&config, &picture) != 0;
  WebPPictureFree(&picture);
  std::optional<std::vector<std::byte>> bytes;
  if (good) {
    const auto* const first = reinterpret_cast<const std::byte*>(writer.mem);
    bytes.emplace(first, first + writer.size);
  }
  WebPMemoryWriterClear(&writer);
  return bytes;
}

float log_place(double v) { return static_cast<float>(std::copysign(std::log1p(std::abs(v)), v)); }

/// Returns the indices of the splats in Morton order of their positions, so that close splats become close pixels.
std::vector<std::uint32_t> morton_order_of(const std::vector<ExportSplat>& splats) {
  Box box;
  for (const ExportSplat& splat : splats) box.add(splat.position);
  const glm::vec3 size = box.size();
  std::vector<std::pair<std::uint64_t, std::uint32_t>> codes;
  codes.reserve(splats.size());
  for (std::size_t i = 0; i < splats.size(); ++i) {
    std::array<std::uint32_t, 3> cell{};
    for (int k = 0; k < 3; ++k)
      if (size[k] > 0)
        cell[static_cast<std::size_t>(k)] =
            static_cast<std::uint32_t>((splats[i].position[k] - box.lower[k]) / size[k] * 1023);
    codes.emplace_back(qnv::morton_encode(cell[0], cell[1], cell[2]), static_cast<std::uint32_t>(i));
  }
  std::ranges::sort(codes);
  std::vector<std::uint32_t> order;
  order.reserve(codes.size());
  for (const auto& code : codes) order.push_back(code.second);
  return order;
}

/// Builder of the images and of meta.json.
class SogBuilder {
 public:
  explicit SogBuilder(ExportSplats made)
      : made_(std::move(made)), order_(morton_order_of(made_.splats)), count_(order_.size()) {
    const auto side = static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(count_))));
    width_ = (side + 3) / 4 * 4;
    height_ = ((count_ + width_ - 1) / width_ + 3) / 4 * 4;
    meta_ = {{"version", 2}, {"asset", {{"generator", "GhostSpace"}}}, {"count", count_}};
    const bool flat = std::ranges::all_of(made_.splats, [](const auto& s) { return s.scale.z <= kLeastScale; });
    if (flat)
      meta_["model"] = "2dgs";
    else
      meta_["antialias"] = made_.antialiased;
  }

  Exported write(const glm::dvec3& origin) {
    add_means(origin);
    add_scales();
    add_rotations();
    add_colors();
    add_harmonics();
    std::vector<std::optional<std::vector<std::byte>>> files(images_.size());
    parallel_for(files.size(), [&](std::size_t i) { files[i] = webp_of(images_[i].second); });
    ZipWriter archive;
    const std::string text = meta_.dump();
    archive.add("meta.json", std::as_bytes(std::span(text)));
    for (std::size_t i = 0; i < files.size(); ++i) {
      if (!files[i]) return "libwebp cannot compress " + images_[i].first;
      if (files[i]->size() > kMostSogBytes - archive.size()) return "SOG is limited to 4 GiB; expected fewer splats";
      archive.add(images_[i].first, *files[i]);
    }
    return archive.take();
  }

 private:
  [[nodiscard]] const ExportSplat& splat(std::size_t i) const { return made_.splats[order_[i]]; }
  SogImage& add_image(const char* name) { return images_.emplace_back(name, SogImage(width_, height_)).second; }
  /// Returns the numbers as values that JSON writes without rounding.
  template <class Numbers>
  static SogJson list_of(const Numbers& numbers) {
    SogJson list = SogJson::array();
    for (const float number : numbers) list.push_back(number);
    return list;
  }

  void add_means(const glm::dvec3& origin) {
    Box logs;
    const auto log_of = [&](std::size_t i) {
      const glm::dvec3 place = origin + glm::dvec3(splat(i).position);
      return glm::vec3(log_place(place.x), log_place(place.y), log_place(place.z));
    };
    for (std::size_t i = 0; i < count_; ++i) logs.add(log_of(i));
    std::array<SogImage, 2> images{SogImage(width_, height_), SogImage(width_, height_)};
    for (std::size_t i = 0; i < count_; ++i) {
      const glm::vec3 place = log_of(i);
      for (int k = 0; k < 3; ++k) {
        const float size = logs.upper[k] - logs.lower[k];
        const auto code = static_cast<unsigned>(size > 0 ? std::lround((place[k] - logs.lower[k]) / size * 65535) : 0);
        images[0].at(i)[k] = static_cast<std::uint8_t>(code & 255);
        images[1].at(i)[k] = static_cast<std::uint8_t>(code >> 8);
      }
    }
    images_.emplace_back("means_l.webp", std::move(images[0]));
    images_.emplace_back("means_u.webp", std::move(images[1]));
    meta_["means"] = {{"mins", list_of(std::array{logs.lower.x, logs.lower.y, logs.lower.z})},
                      {"maxs", list_of(std::array{logs.upper.x, logs.upper.y, logs.upper.z})},
                      {"files", {"means_l.webp", "means_u.webp"}}};
  }

  void add_scales() {
    const int axes = meta_.contains("model") ? 2 : 3;
    const auto log_of = [](float scale) { return std::clamp(std::log(scale), kLeastLogScale, kMostLogScale); };
    std::vector<float> values;
    values.reserve(3 * count_);
    for (std::size_t i = 0; i < count_; ++i)
      for (int k = 0; k < axes; ++k) values.push_back(log_of(splat(i).scale[k]));
    const SogCodebook codebook = sog_codebook_of(std::move(values));
    SogImage& image = add_image("scales.webp");
    for (std::size_t i = 0; i < count_; ++i)
      for (int k = 0; k < 3; ++k) image.at(i)[k] = k < axes ? sog_code_of(codebook, log_of(splat(i).scale[k])) : 0;
    meta_["scales"] = {{"codebook", list_of(codebook)}, {"files", {"scales.webp"}}};
  }

  void add_rotations() {
    SogImage& image = add_image("quats.webp");
    for (std::size_t i = 0; i < count_; ++i) {
      const glm::vec4& q = splat(i).rotation;
      const std::array<float, 4> wxyz{q.w, q.x, q.y, q.z};
      std::size_t largest = 0;
      for (std::size_t k = 1; k < 4; ++k)
        if (std::abs(wxyz[k]) > std::abs(wxyz[largest])) largest = k;
      const float sign = wxyz[largest] < 0 ? -1 : 1;
      std::size_t next = 0;
      for (std::size_t k = 0; k < 4; ++k) {
        if (k == largest) continue;
        const float part = sign * wxyz[k] / std::numbers::sqrt2_v<float> + 0.5f;
        image.at(i)[next++] = static_cast<std::uint8_t>(std::lround(std::clamp(part, 0.0f, 1.0f) * 255));
      }
      image.at(i)[3] = static_cast<std::uint8_t>(252 + largest);
    }
    meta_["quats"] = {{"files", {"quats.webp"}}};
  }

  void add_colors() {
    std::vector<float> values;
    values.reserve(3 * count_);
    for (std::size_t i = 0; i < count_; ++i)
      for (int k = 0; k < 3; ++k) values.push_back(splat(i).dc[k]);
    const SogCodebook codebook = sog_codebook_of(std::move(values));
    SogImage& image = add_image("sh0.webp");
    for (std::size_t i = 0; i < count_; ++i) {
      for (int k = 0; k < 3; ++k) image.at(i)[k] = sog_code_of(codebook, splat(i).dc[k]);
      image.at(i)[3] = static_cast<std::uint8_t>(std::lround(std::clamp(splat(i).opacity, 0.0f, 1.0f) * 255));
    }
    meta_["sh0"] = {{"codebook", list_of(codebook)}, {"files", {"sh0.webp"}}};
  }

  void add_harmonics() {
    if (made_.degree == 0) return;
    const std::size_t per = qnv::harmonic_count(made_.degree), dimensions = 3 * per;
    const std::span<const float> points(&made_.harmonics.front().x, 3 * made_.harmonics.size());
    const std::size_t entries =
        std::min(kMostSogPalette, std::bit_floor(std::max<std::size_t>(1, count_ / 1024)) * kSogPaletteUnit);
    const SogPalette palette = sog_palette_of(points, dimensions, entries);
    SogImage& labels = add_image("shN_labels.webp");
    for (std::size_t i = 0; i < count_; ++i) {
      const std::uint16_t label = palette.labels[order_[i]];
      labels.at(i)[0] = static_cast<std::uint8_t>(label & 255);
      labels.at(i)[1] = static_cast<std::uint8_t>(label >> 8);
      labels.at(i)[2] = 0;
    }
    const SogCodebook codebook = sog_codebook_of(palette.centers);
    const std::size_t found = palette.centers.size() / dimensions;
    SogImage centers(kSogCentersPerRow * per, (found + kSogCentersPerRow - 1) / kSogCentersPerRow);
    for (std::size_t i = 0; i < palette.centers.size(); ++i)
      centers.at(i / 3)[i % 3] = sog_code_of(codebook, palette.centers[i]);
    images_.emplace_back("shN_centroids.webp", std::move(centers));
    meta_["shN"] = {{"count", found},
                    {"bands", made_.degree},
                    {"codebook", list_of(codebook)},
                    {"files", {"shN_centroids.webp", "shN_labels.webp"}}};
  }

  ExportSplats made_;
  std::vector<std::uint32_t> order_;  // index of the splat of each pixel
  std::size_t count_ = 0, width_ = 0, height_ = 0;
  SogJson meta_;
  std::vector<std::pair<std::string, SogImage>> images_;
};

/// Returns true if the rounding of SOG deforms content that is far from 0: by the steps of 16 bits, or of logarithms in
/// float32.
bool is_too_far_for_sog(const qnv::Description& description) {
  if (description.origin == glm::dvec3(0)) return false;
  for (int k = 0; k < 3; ++k) {
    const double far = std::abs(description.origin[k]), size = static_cast<double>(description.box.size()[k]);
    const double range = std::log1p(far + size) - std::log1p(std::max(0.0, far - size));
    const double step = (1 + far) * std::max(range / 65535, std::log1p(far) * 0x1p-23);
    if (size > 0 && step * double{kMinSogSteps} > size) return true;
  }
  return false;
}

}  // namespace

Exported export_sog(const qnv::Geometry& geometry, const ExportOptions&) {
  ExportSplats made = splats_of(geometry, kFromRightDownForward);
  if (made.splats.empty()) return "SOG needs at least one visible vector";
  if (made.splats.size() > kMostSogSide * kMostSogSide)
    return "too many splats for SOG (" + std::to_string(made.splats.size()) + "); expected at most " +
           std::to_string(kMostSogSide * kMostSogSide);
  if (is_too_far_for_sog(geometry.description()))
    return "SOG has 16 bits per coordinate, too few at this distance from 0; expected .3dgs.ply or .splats.glb, which "
           "keep the positions";
  return SogBuilder(std::move(made)).write(geometry.description().origin * glm::dvec3(kFromRightDownForward));
}

}  // namespace gs::app
