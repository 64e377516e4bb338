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

bool is_good(const VectorView& vectors, std::size_t i) {
  const float weight = vectors.weights[i];
  return finite(vectors.positions[i]) && finite(vectors.normals[i]) &&
         glm::dot(vectors.normals[i], vectors.normals[i]) > 0 && weight > 0 && std::isfinite(weight);
}

/// Passes one square per vector to the sink, with the vector's area and direction.
bool for_each_square(const VectorView& vectors, const TriangleSink& sink) {
  std::vector<Triangle> batch;
  batch.reserve(2 * kDiscsTogether);
  for (std::size_t i = 0; i < vectors.size(); ++i) {
    const glm::vec3 &p = vectors.positions[i], &n = vectors.normals[i];
    if (is_good(vectors, i)) {
      const glm::vec3 other = std::abs(n.x) < 0.7f ? glm::vec3(1, 0, 0) : glm::vec3(0, 1, 0);
      const glm::vec3 along = glm::normalize(glm::cross(n, other)), across = glm::cross(n, along);
      const float half = std::sqrt(vectors.weights[i]) / 2;
      const glm::vec3 u = along * half, v = across * half;
      Triangle triangle;
      triangle.normals.fill(n);
      triangle.colors.fill(vectors.colors.empty() ? vectors.color : vectors.colors[i]);
      triangle.positions = {p - u - v, p + u - v, p + u + v};
      batch.push_back(triangle);
      triangle.positions = {p - u - v, p + u + v, p - u + v};
      batch.push_back(triangle);
    }
    if (batch.size() < 2 * kDiscsTogether && i + 1 < vectors.size()) continue;
    if (!batch.empty() && !sink(batch)) return false;
    batch.clear();
  }
  return true;
}

}  // namespace

std::variant<EncodedStream, EncodeError> encode_points(const VectorView& vectors, const EncodeOptions& options,
                                                       Progress* progress) {
  if (vectors.kind != Kind::surface)
    return EncodeError{"a packed stream needs a surface; gradients of a volume are not supported"};
  if (vectors.normals.size() != vectors.size() || vectors.weights.size() != vectors.size() ||
      vectors.size() > std::numeric_limits<std::uint32_t>::max())
    return EncodeError{"the vectors cannot be encoded; expected fewer than 2^32, each with a normal and a weight"};
  const Description description = describe_vectors(vectors, options.metadata);
  if (!(description.total > 0)) return EncodeError{"no vectors to encode"};
  if (!std::isfinite(description.total) || !finite(description.box.size()))
    return EncodeError{"the vectors are too large or too far apart"};
  EncodeOptions rest = options;
  rest.metadata = description.metadata;
  rest.origin = description.origin;
  rest.two_sided = description.two_sided;
  if (rest.vectors == 0 && rest.max_bytes == 0) rest.vectors = vectors.size();
  const TriangleSource squares = [&vectors](const TriangleSink& sink) { return for_each_square(vectors, sink); };
  return encode_surface(squares, rest, progress);
}

}  // namespace gs::qnv
