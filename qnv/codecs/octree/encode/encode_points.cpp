#include "base/finite.h"
#include "qnv/codecs/octree/encode/encode_surface.h"
#include "qnv/codecs/shared/encode_options.h"
#include "qnv/mesh/survey.h"

#include <glm/geometric.hpp>

#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

namespace gs::qnv {
namespace {

constexpr std::size_t kDiscsTogether = 2048;

bool is_good(const Cloud& cloud, std::size_t i) {
  const float weight = cloud.weights[i];
  return finite(cloud.positions[i]) && finite(cloud.normals[i]) && glm::dot(cloud.normals[i], cloud.normals[i]) > 0 &&
         weight > 0 && std::isfinite(weight);
}

/// Passes to the sink a square for each vector, with its area and direction.
bool for_each_square(const Cloud& cloud, const TriangleSink& sink) {
  std::vector<Triangle> batch;
  batch.reserve(2 * kDiscsTogether);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const glm::vec3 &p = cloud.positions[i], &n = cloud.normals[i];
    if (is_good(cloud, i)) {
      const glm::vec3 other = std::abs(n.x) < 0.7f ? glm::vec3(1, 0, 0) : glm::vec3(0, 1, 0);
      const glm::vec3 along = glm::normalize(glm::cross(n, other)), across = glm::cross(n, along);
      const float half = std::sqrt(cloud.weights[i]) / 2;
      const glm::vec3 u = along * half, v = across * half;
      Triangle triangle;
      triangle.normals.fill(n);
      triangle.colors.fill(cloud.colors.empty() ? cloud.color : cloud.colors[i]);
      triangle.positions = {p - u - v, p + u - v, p + u + v};
      batch.push_back(triangle);
      triangle.positions = {p - u - v, p + u + v, p - u + v};
      batch.push_back(triangle);
    }
    if (batch.size() < 2 * kDiscsTogether && i + 1 < cloud.size()) continue;
    if (!batch.empty() && !sink(batch)) return false;
    batch.clear();
  }
  return true;
}

}  // namespace

std::variant<EncodedStream, EncodeError> encode_points(const Cloud& cloud, const EncodeOptions& options,
                                                       Progress* progress) {
  if (cloud.description.kind != Kind::surface)
    return EncodeError{"a packed stream needs a surface; gradients of a volume are not supported"};
  if (cloud.normals.size() != cloud.size() || cloud.weights.size() != cloud.size() ||
      cloud.size() > std::numeric_limits<std::uint32_t>::max())
    return EncodeError{"the vectors cannot be encoded; expected fewer than 2^32, each with a normal and a weight"};
  const Description description = describe_vectors(cloud, options.metadata);
  if (!(description.total > 0)) return EncodeError{"no vectors to encode"};
  if (!std::isfinite(description.total) || !finite(description.box.size()))
    return EncodeError{"the vectors are too large or too far apart"};
  EncodeOptions rest = options;
  rest.payload = Payload::packed;
  rest.metadata = description.metadata;
  rest.origin = description.origin;
  rest.two_sided = description.two_sided;
  if (rest.vectors == 0 && rest.max_bytes == 0) rest.vectors = cloud.size();
  const TriangleSource squares = [&cloud](const TriangleSink& sink) { return for_each_square(cloud, sink); };
  return encode_surface(squares, rest, progress);
}

}  // namespace gs::qnv
