#pragma once

#include "render/gl/gpu.h"
#include "render/gl/range_allocator.h"
#include "vrml/mesh/mesh.h"

#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <unordered_map>
#include <vector>

namespace gs::render {

/// What one instance of a mesh needs, as the vertex shader reads it. Camera space is that of the camera
/// that draws, so that float32 stays precise far from the world's origin.
struct Instance {
  float camera_from_node[3][4];  // rows of an affine matrix; from the node's space about the slice's origin
  float base_color[3], alpha;    // diffuse when lit
  float emissive[3], ambient_intensity;
  float specular[3], shininess;  // exponent: 128 * the field
};
static_assert(sizeof(Instance) == 24 * sizeof(float));

/// The place in a mesh's space from which its positions count on the GPU: the middle where it lies many times its size
/// from the origin, as the parts of a map do, so that the vertex shader has no large numbers to take from each other.
[[nodiscard]] glm::vec3 local_origin(const vrml::Bounds& bounds);

/// Keeps meshes in the memory of the GPU. Small meshes of the same make-up share pages (a vertex
/// array, a vertex buffer and an index buffer), so that many of them are drawn without switching.
class MeshStore {
 public:
  /// A mesh in its page.
  struct Slice {
    std::uint32_t page = 0;
    std::uint32_t order = 0;  // unique among the slices that live; for sorting
    GLint base_vertex = 0;
    std::size_t first_index = 0;
    GLsizei index_count = 0;
    GLenum primitive = GL_TRIANGLES;
    bool normals = false, colors = false, texture_coordinates = false;
    bool streamed = false;  // it lies in what set_streamed was given, not in a page
    bool sorted = false;    // first_index counts in the sorted indices, not in the page
    glm::vec3 origin{0};    // from which its positions count; see local_origin
  };

  explicit MeshStore(const Gl& gl);

  /// Where the mesh lies, after uploading it if need be; null when it cannot be drawn (nothing in
  /// it, an index out of range, no memory). Valid until the next call of `forget_unused`.
  const Slice* find(const std::shared_ptr<const vrml::Mesh>& mesh);
  /// Bytes that were uploaded since the beginning.
  [[nodiscard]] std::size_t uploaded() const { return uploaded_; }
  /// Frees the copies of meshes that nobody holds any more.
  void forget_unused();

  /// Fills the instance buffer for the draws that follow.
  void set_instances(const std::vector<Instance>& instances);
  /// Likewise, the indices of slices that are sorted.
  void set_sorted_indices(const std::vector<std::uint32_t>& indices);
  /// A corner of what is drawn once: position, place in the texture, colour.
  struct StreamedVertex {
    float position[3], texture_coordinate[2], color[3];
  };
  /// Triangles of one frame, with indices; slices of them have `streamed` set, count from index 0 and have colours and
  /// texture coordinates.
  void set_streamed(std::span<const StreamedVertex> vertices, std::span<const std::uint32_t> indices);
  /// Draws `count` instances from number `first` on with the program in use.
  void draw(const Slice& slice, std::size_t first, std::size_t count);
  /// To be called before the first `draw` after somebody else used vertex arrays.
  void forget_binding() { bound_page_ = kNoPage; }

 private:
  struct Page {
    unsigned format = 0;                    // bits: normals, colors, texture coordinates
    std::size_t vertices = 0, indices = 0;  // capacity
    std::size_t meshes = 0;                 // living in it
    RangeAllocator free_vertices{0}, free_indices{0};
    VertexArray vertex_array;
    Buffer vertex_buffer, index_buffer;
  };
  struct Entry {
    std::weak_ptr<const vrml::Mesh> mesh;
    Slice slice;
    std::size_t vertices = 0;
    bool drawable = false;
  };
  static constexpr std::uint32_t kNoPage = UINT32_MAX, kStreamedPage = UINT32_MAX - 1;

  void upload(const vrml::Mesh& mesh, Entry& entry);
  void release(Entry& entry);
  bool place(unsigned format, std::size_t vertices, std::size_t indices, Entry& entry);
  bool place_in(std::uint32_t page, std::size_t vertices, std::size_t indices, Entry& entry);
  bool add_page(unsigned format, std::size_t vertices, std::size_t indices);
  void bind(const Slice& slice);
  void point_at_instances(std::size_t first);

  const Gl& gl_;
  Buffer instances_, sorted_indices_;
  struct Streamed {
    VertexArray vertex_array;
    Buffer vertices, indices;
  };
  std::unique_ptr<Streamed> streamed_;        // null until something was
  std::vector<std::unique_ptr<Page>> pages_;  // null where a page was freed
  std::unordered_map<const vrml::Mesh*, Entry> entries_;
  std::uint32_t bound_page_ = kNoPage, next_order_ = 0;
  std::size_t uploaded_ = 0;
};

}  // namespace gs::render
