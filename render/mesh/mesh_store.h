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

/// Data of one mesh instance as the vertex shader reads it. Camera space is that of the drawing camera, so that float32
/// stays precise far from the world's origin.
struct Instance {
  float camera_from_node[3][4];  // rows of an affine matrix; from node space relative to the slice's origin
  float base_color[3], alpha;    // diffuse if lit
  float emissive[3], ambient_intensity;
  float specular[3], shininess;  // exponent: 128 * the field
};
static_assert(sizeof(Instance) == 24 * sizeof(float));

/// Returns the origin of the mesh's positions on the GPU. It is the centre if that lies many mesh sizes from 0, as in
/// parts of a map; the vertex shader then avoids differences of large numbers.
[[nodiscard]] glm::vec3 local_origin(const Box& bounds);

/// Caches meshes in GPU memory. Small meshes of the same format share pages, so that they are drawn without state
/// changes. A page has a vertex array, a vertex buffer and an index buffer.
class MeshStore {
 public:
  /// Location of a mesh in its page.
  struct Slice {
    std::uint32_t page = 0;
    std::uint32_t order = 0;  // unique among present slices; for sorting
    GLint base_vertex = 0;
    std::size_t first_index = 0;
    GLsizei index_count = 0;
    GLenum primitive = GL_TRIANGLES;
    bool normals = false, colors = false, texture_coordinates = false;
    bool streamed = false;  // in the data of set_streamed, not in a page
    bool sorted = false;    // first_index refers to the sorted indices, not to the page
    glm::vec3 origin{0};    // origin of its positions; see local_origin
  };

  explicit MeshStore(const Gl& gl);

  /// Returns the location of the mesh and uploads it if needed; null if it cannot be drawn (empty, index out of range,
  /// no memory). Valid until the next `forget_unused`.
  const Slice* find(const std::shared_ptr<const vrml::Mesh>& mesh);
  /// Returns the total of uploaded bytes.
  [[nodiscard]] std::size_t uploaded() const { return uploaded_; }
  /// Frees copies of meshes without other owners.
  void forget_unused();

  /// Fills the instance buffer for the following draws.
  void set_instances(const std::vector<Instance>& instances);
  /// Sets the indices of slices that are sorted.
  void set_sorted_indices(const std::vector<std::uint32_t>& indices);
  /// Vertex of geometry that is drawn once: position, texture coordinate, colour.
  struct StreamedVertex {
    float position[3], texture_coordinate[2], color[3];
  };
  /// Sets the triangles of one frame. Their slices have `streamed` set, count from index 0, and have colours and
  /// texture coordinates.
  void set_streamed(std::span<const StreamedVertex> vertices, std::span<const std::uint32_t> indices);
  /// Draws `count` instances from number `first` with the program in use.
  void draw(const Slice& slice, std::size_t first, std::size_t count);
  /// Call it before the first `draw` after other code used vertex arrays.
  void forget_binding() { bound_page_ = kNoPage; }

 private:
  struct Page {
    unsigned format = 0;                    // format bits: normals, colors, texture coordinates
    std::size_t vertices = 0, indices = 0;  // capacity
    std::size_t meshes = 0;                 // meshes in the page
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
  std::unique_ptr<Streamed> streamed_;        // null until first used
  std::vector<std::unique_ptr<Page>> pages_;  // null if the page was freed
  std::unordered_map<const vrml::Mesh*, Entry> entries_;
  std::uint32_t bound_page_ = kNoPage, next_order_ = 0;
  std::size_t uploaded_ = 0;
};

}  // namespace gs::render
