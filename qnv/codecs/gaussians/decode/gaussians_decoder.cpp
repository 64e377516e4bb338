#include "qnv/codecs/gaussians/decode/splat_forest.h"
#include "qnv/codecs/gaussians/splat_steps.h"
#include "qnv/codecs/shared/decoder.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

namespace gs::qnv {
namespace {

using gaussians::SplatForest;
using gaussians::SplatNode;

Rgb8 nearest_color(const glm::vec3& color) {
  const auto part = [](float c) { return static_cast<std::uint8_t>(std::lround(std::clamp(c, 0.0f, 1.0f) * 255)); };
  return {part(color.x), part(color.y), part(color.z)};
}

/// Decoder of the Gaussians payload.
class GaussiansDecoder final : public Decoder {
 public:
  GaussiansDecoder(const StreamHeader& header, std::size_t most_vectors)
      : antialiased_(header.gaussians.antialiased), forest_(header.gaussians, header.description.box, most_vectors) {}

  void add(ChunkType type, std::span<const std::byte> payload, std::span<const ByteRange>) override {
    if (is_harmonics(type))
      forest_.add_harmonics(payload, type == ChunkType::coarse_harmonics);
    else
      forest_.add_cluster(payload);
  }
  [[nodiscard]] DecodeCount count() const override { return forest_.count(); }
  [[nodiscard]] std::size_t vectors() const override { return forest_.shown(); }
  [[nodiscard]] Geometry geometry(GeometryBase base) const override {
    Gaussians all{std::move(base)};
    const std::size_t count = forest_.shown();
    all.antialiased = antialiased_;
    all.degree = forest_.has_harmonics() ? forest_.degree() : 0;
    const std::size_t per = harmonic_count(all.degree);
    all.positions.reserve(count);
    all.normals.reserve(count);
    all.weights.reserve(count);
    all.colors.reserve(count);
    all.scales.reserve(count);
    all.rotations.reserve(count);
    all.opacities.reserve(count);
    all.bases.reserve(count);
    all.harmonics.reserve(per * count);
    const Box& box = all.description.box;
    const glm::vec3 middle = box.lower + box.size() * 0.5f;
    forest_.visit_shown([&](const SplatNode& node, const glm::vec3* harmonics) {
      glm::vec3 scales;
      const gaussians::SplatLook look = gaussians::look_of(node, forest_.precision());
      for (int k = 0; k < 3; ++k) scales[k] = static_cast<float>(look.scales[static_cast<std::size_t>(k)]);
      // The shortest axis is the normal of the disc; it points away from the middle.
      const auto axis = gaussians::axes_of(node.rotation)[2];
      glm::vec3 normal(static_cast<float>(axis[0]), static_cast<float>(axis[1]), static_cast<float>(axis[2]));
      normal = glm::normalize(normal);
      if (glm::dot(normal, node.position - middle) < 0) normal = -normal;
      all.positions.push_back(node.position);
      all.normals.push_back(normal);
      all.weights.push_back(2 * std::numbers::pi_v<float> * scales.x * scales.y);
      all.colors.push_back(nearest_color(node.color));
      all.scales.push_back(scales);
      all.rotations.push_back(node.rotation);
      all.opacities.push_back(static_cast<float>(look.opacity));
      all.bases.push_back(node.color);
      for (std::size_t k = 0; k < per; ++k) all.harmonics.push_back(harmonics ? harmonics[k] : glm::vec3(0));
    });
    return all;
  }

 private:
  bool antialiased_;
  SplatForest forest_;
};

}  // namespace

std::unique_ptr<Decoder> make_gaussians_decoder(const StreamHeader& header, std::size_t most_vectors) {
  return std::make_unique<GaussiansDecoder>(header, most_vectors);
}

}  // namespace gs::qnv
