#include "bench/shared/sog_peer.h"

#include "qnv/base/morton.h"

#include <webp/encode.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

namespace gs::bench {
namespace {

constexpr std::size_t kMetaBytes = 5000;  // of meta.json with its tables

/// Image of one pixel for each Gaussian.
class Plane {
 public:
  explicit Plane(std::size_t count)
      : width_(4 * static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(count)) / 4))),
        height_((count + width_ - 1) / width_),
        pixels_(4 * width_ * height_, 255) {}

  std::uint8_t* at(std::size_t i) { return pixels_.data() + 4 * i; }
  [[nodiscard]] std::size_t coded_bytes() const {
    std::uint8_t* out = nullptr;
    WebPConfig config;
    WebPPicture picture;
    if (!WebPConfigInit(&config) || !WebPConfigLosslessPreset(&config, 6) || !WebPPictureInit(&picture)) return 0;
    config.exact = 1;
    picture.use_argb = 1;
    picture.width = static_cast<int>(width_);
    picture.height = static_cast<int>(height_);
    WebPMemoryWriter writer;
    WebPMemoryWriterInit(&writer);
    picture.writer = WebPMemoryWrite;
    picture.custom_ptr = &writer;
    std::size_t bytes = 0;
    if (WebPPictureImportRGBA(&picture, pixels_.data(), static_cast<int>(4 * width_)) && WebPEncode(&config, &picture))
      bytes = writer.size;
    WebPPictureFree(&picture);
    out = writer.mem;
    WebPFree(out);
    return bytes;
  }

 private:
  std::size_t width_, height_;
  std::vector<std::uint8_t> pixels_;
};

/// Table of 256 numbers for given ones (k-means on a line).
class Table {
 public:
  explicit Table(std::vector<float> numbers) {
    std::ranges::sort(numbers);
    std::vector<double> sums(numbers.size() + 1, 0);
    for (std::size_t i = 0; i < numbers.size(); ++i) sums[i + 1] = sums[i] + static_cast<double>(numbers[i]);
    for (std::size_t k = 0; k < values_.size(); ++k)
      values_[k] = numbers[(2 * k + 1) * (numbers.size() - 1) / (2 * values_.size())];
    for (int round = 0; round < 20; ++round) {
      std::size_t from = 0;
      for (std::size_t k = 0; k < values_.size(); ++k) {
        std::size_t to = numbers.size();
        if (k + 1 < values_.size()) {
          const float between = (values_[k] + values_[k + 1]) / 2;
          to = static_cast<std::size_t>(std::ranges::lower_bound(numbers, between) - numbers.begin());
        }
        to = std::max(to, from);
        if (to > from) values_[k] = static_cast<float>((sums[to] - sums[from]) / static_cast<double>(to - from));
        from = to;
      }
    }
  }
  [[nodiscard]] std::uint8_t nearest(float number) const {
    const auto above = std::ranges::lower_bound(values_, number);
    const auto i = static_cast<std::size_t>(above - values_.begin());
    if (i == 0) return 0;
    if (i == values_.size() || number - values_[i - 1] < values_[i] - number) return static_cast<std::uint8_t>(i - 1);
    return static_cast<std::uint8_t>(i);
  }
  [[nodiscard]] float operator[](std::uint8_t i) const { return values_[i]; }

 private:
  std::array<float, 256> values_{};
};

std::vector<std::size_t> morton_order(const qnv::Gaussians& source) {
  const Box& box = source.description.box;
  const glm::vec3 size = box.size();
  const float edge = std::max({size.x, size.y, size.z, 1e-30f});
  std::vector<std::pair<std::uint64_t, std::size_t>> keys;
  for (std::size_t i = 0; i < source.size(); ++i) {
    const glm::vec3 p = (source.positions[i] - box.lower) / edge * 1048575.0f;
    keys.emplace_back(qnv::morton_encode(static_cast<std::uint32_t>(p.x), static_cast<std::uint32_t>(p.y),
                                         static_cast<std::uint32_t>(p.z)),
                      i);
  }
  std::ranges::sort(keys);
  std::vector<std::size_t> order;
  for (const auto& key : keys) order.push_back(key.second);
  return order;
}

float flattened(float v) { return std::copysign(std::log1p(std::abs(v)), v); }
float unflattened(float v) { return std::copysign(std::expm1(std::abs(v)), v); }

}  // namespace

SogPeer sog_of(const qnv::Gaussians& source) {
  SogPeer peer;
  qnv::Gaussians& out = peer.gaussians;
  const std::size_t count = source.size();
  const std::vector<std::size_t> order = morton_order(source);
  Plane high(count), low(count), turns(count), deviations(count), colors(count);
  std::vector<float> logarithms, components;
  for (std::size_t i = 0; i < count; ++i)
    for (int k = 0; k < 3; ++k) {
      logarithms.push_back(std::log(std::max(source.scales[i][k], 1e-10f)));
      components.push_back(source.bases[i][k]);
    }
  const Table scale_table(std::move(logarithms)), color_table(std::move(components));
  const Box& box = source.description.box;
  for (std::size_t at = 0; at < count; ++at) {
    const std::size_t i = order[at];
    glm::vec3 position, scale, base;
    for (int k = 0; k < 3; ++k) {
      const float least = flattened(box.lower[k]), most = flattened(box.upper[k]),
                  range = std::max(most - least, 1e-30f);
      const auto code = static_cast<std::uint32_t>(
          std::clamp(std::lround((flattened(source.positions[i][k]) - least) / range * 65535), 0l, 65535l));
      high.at(at)[k] = static_cast<std::uint8_t>(code >> 8);
      low.at(at)[k] = static_cast<std::uint8_t>(code);
      position[k] = unflattened(least + static_cast<float>(code) / 65535 * range);
      deviations.at(at)[k] = scale_table.nearest(std::log(std::max(source.scales[i][k], 1e-10f)));
      scale[k] = std::exp(scale_table[deviations.at(at)[k]]);
      colors.at(at)[k] = color_table.nearest(source.bases[i][k]);
      base[k] = color_table[colors.at(at)[k]];
    }
    const auto opacity = static_cast<std::uint8_t>(std::lround(std::clamp(source.opacities[i], 0.0f, 1.0f) * 255));
    colors.at(at)[3] = opacity;
    const glm::vec4& q = source.rotations[i];
    std::array<float, 4> parts{q.w, q.x, q.y, q.z};
    const auto largest = static_cast<std::size_t>(
        std::ranges::max_element(parts, {}, [](float v) { return std::abs(v); }) - parts.begin());
    if (parts[largest] < 0)
      for (float& part : parts) part = -part;
    float rest = 1;
    for (std::size_t k = 0, next = 0; k < 4; ++k) {
      if (k == largest) continue;
      const auto code =
          static_cast<std::uint8_t>(std::clamp(std::lround((parts[k] / std::sqrt(2.0f) + 0.5f) * 255), 0l, 255l));
      turns.at(at)[next++] = code;
      parts[k] = (static_cast<float>(code) / 255 - 0.5f) * std::sqrt(2.0f);
      rest -= parts[k] * parts[k];
    }
    parts[largest] = std::sqrt(std::max(rest, 0.0f));
    turns.at(at)[3] = static_cast<std::uint8_t>(252 + largest);
    out.positions.push_back(position);
    out.scales.push_back(scale);
    out.rotations.emplace_back(parts[1], parts[2], parts[3], parts[0]);
    out.opacities.push_back(static_cast<float>(opacity) / 255);
    out.bases.push_back(base);
  }
  for (const Plane* plane : {&high, &low, &turns, &deviations, &colors}) peer.bytes += plane->coded_bytes();
  peer.bytes += kMetaBytes;
  out.description = source.description;
  out.antialiased = source.antialiased;
  return peer;
}

}  // namespace gs::bench
