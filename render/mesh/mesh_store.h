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

/// Data of one mesh instance, in the vertex shader's layout. Camera space is that of the current camera, so that
/// float32 is precise far from the world's origin.
struct Instance {
  float camera_from_node[3][4];  // rows of the matrix from node space, relative to Slice::origin, to camera space
  float base_color[3], alpha;    // diffuse colour if lit
  float emissive[3], ambient_intensity;
  float specular[3], shininess;  // specular exponent: 128 * the field `shininess`
};
static_assert(sizeof(Instance) == 24 * sizeof(float));

/// Returns the origin of the mesh's positions on the GPU. Returns the centre if it is many mesh sizes from 0, as in
/// parts of a map. The vertex shader then avoids differences of large numbers.
[[nodiscard]] glm::vec3 local_origin(const Box& bounds);

/// Meshes in GPU memory. Small meshes with the same format share pages, so that drawing them needs no state changes. A
/// page has a vertex array, a vertex buffer and an index buffer.
class MeshStore {
 public:
  /// Location of a mesh in its page.
  struct Slice {
    std::uint32_t page = 0;
    std::uint32_t order = 0;  // unique among the stored slices; for sorting
    GLint base_vertex = 0;
    std::size_t first_index = 0;
    GLsizei index_count = 0;
    GLenum primitive = GL_TRIANGLES;
    bool normals = false, colors = false, texture_coordinates = false, opacities = false, fog_depths = false;
    std::uint8_t coordinate_sets = 0;  // number of vrml::Mesh::coordinate_sets
    bool streamed = false;  // data is in the buffers of set_streamed(), not in a page
    bool sorted = false;  // first_index is an index in the sorted indices, not in the page
    glm::vec3 origin{0};  // origin of its positions; see local_origin()
  };

  explicit MeshStore(const Gl& gl);

  /// Returns the location of a mesh, and uploads the mesh if necessary. Returns null if the mesh cannot be drawn: it is
  /// empty, an index is out of range, or memory is missing. Valid until the next `forget_unused`.
  const Slice* find(const std::shared_ptr<const vrml::Mesh>& mesh);
  /// Returns the bytes uploaded so far.
  [[nodiscard]] std::size_t uploaded() const { return uploaded_; }
  /// Frees meshes that have no other owners.
  void forget_unused();

  /// Sets the instances that the following draws use.
  void set_instances(const std::vector<Instance>& instances);
  /// Sets the indices of the slices with `sorted`.
  void set_sorted_indices(const std::vector<std::uint32_t>& indices);
  /// Vertex of a mesh that is drawn in one frame only: position, texture coordinate, colour.
  struct StreamedVertex {
    float position[3], texture_coordinate[2], color[3];
  };
  /// Sets triangles for one frame. Their slices have `streamed`, colours and texture coordinates; first_index counts
  /// from 0.
  void set_streamed(std::span<const StreamedVertex> vertices, std::span<const std::uint32_t> indices);
  /// Draws `count` instances from index `first` on, with the current program.
  void draw(const Slice& slice, std::size_t first, std::size_t count);
  /// Arguments of a draw in the layout of OpenGL (DrawElementsIndirectCommand).
  struct Command {
    GLuint index_count, instances, first_index;
    GLint base_vertex;
    GLuint first_instance;
  };
  /// Reports whether draw_many() is available.
  [[nodiscard]] bool draws_many() const { return gl_.MultiDrawElementsIndirect != nullptr; }
  /// Draws several meshes of one page in one call, with the current program. `any` is one of their slices; all or
  /// none have `sorted`.
  void draw_many(const Slice& any, std::span<const Command> commands);
  /// Forgets the bound page. Call it before the first `draw` after other code has bound a vertex array.
  void forget_binding() { bound_page_ = kNoPage; }

 private:
  struct Page {
    unsigned format = 0;  // bits: the arrays that the vertices have; then the number of coordinate sets
    std::size_t vertices = 0, indices = 0;  // capacities
    std::size_t meshes = 0;                 // number of meshes in the page
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
  Buffer instances_, sorted_indices_, commands_;
  struct Streamed {
    VertexArray vertex_array;
    Buffer vertices, indices;
  };
  std::unique_ptr<Streamed> streamed_;        // null before its first use
  std::vector<std::unique_ptr<Page>> pages_;  // null for a page that was freed
  std::unordered_map<const vrml::Mesh*, Entry> entries_;
  std::uint32_t bound_page_ = kNoPage, next_order_ = 0;
  std::size_t uploaded_ = 0;
};

}  // namespace gs::render
