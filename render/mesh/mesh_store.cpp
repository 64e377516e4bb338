#include "render/mesh/mesh_store.h"

#include <glm/vec4.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

namespace gs::render {
namespace {

constexpr unsigned kNormals = 1, kColors = 2, kTextureCoordinates = 4, kOpacities = 8, kFogDepths = 16, kFirstSet = 32;
// maximum vertices of a mesh that shares a page; a larger mesh has a page of its size
constexpr std::size_t kLargestShared = 16 * 1024;
constexpr std::size_t kSmallestPage = 8 * 1024, kLargestPage = 256 * 1024;  // vertices of a shared page
constexpr std::size_t kIndicesPerVertex = 6;                                // of a page; closed surfaces have about 6

// Attribute locations in the vertex shader (shaders.h).
enum Location : GLuint {
  kPosition,
  kNormal,
  kColor,
  kTextureCoordinate,
  kFirstInstance,
  kCoordinateSets = 10,
  kFogDepth = 15
};
constexpr GLuint kInstanceVectors = sizeof(Instance) / (4 * sizeof(float));

/// One array in a vertex buffer. The buffer has all positions, then all normals, and so on.
struct ArrayPlace {
  Location location;
  GLint components;
  std::size_t offset;  // byte offset in the buffer
};

struct Layout {
  std::array<ArrayPlace, 5 + vrml::kMaxCoordinateSets> arrays{};
  std::size_t count = 0, bytes = 0;
};

Layout layout(unsigned format, std::size_t vertices) {
  Layout result;
  const auto add = [&](Location location, GLint components) {
    result.arrays[result.count++] = {location, components, result.bytes};
    result.bytes += vertices * static_cast<std::size_t>(components) * sizeof(float);
  };
  add(kPosition, 3);
  if (format & kNormals) add(kNormal, 3);
  if (format & kColors) add(kColor, format & kOpacities ? 4 : 3);
  if (format & kTextureCoordinates) add(kTextureCoordinate, 2);
  for (unsigned set = 0; set < format / kFirstSet; ++set) add(static_cast<Location>(kCoordinateSets + set), 4);
  if (format & kFogDepths) add(kFogDepth, 1);
  return result;
}

const void* bytes_of(const vrml::Mesh& mesh, Location location) {
  if (location >= kCoordinateSets && location < kFogDepth)
    return mesh.coordinate_sets[location - kCoordinateSets].data();
  switch (location) {
    case kNormal:
      return mesh.normals.data();
    case kColor:
      return mesh.colors.data();
    case kTextureCoordinate:
      return mesh.texture_coordinates.data();
    case kFogDepth:
      return mesh.fog_depths.data();
    default:
      return mesh.positions.data();
  }
}

bool indices_in_range(const vrml::Mesh& mesh) {
  std::uint32_t largest = 0;
  for (const std::uint32_t index : mesh.indices) largest = std::max(largest, index);
  return largest < mesh.positions.size();
}

}  // namespace

glm::vec3 local_origin(const Box& bounds) {
  constexpr float kFar = 8;  // distance from 0, in half extents, up to which float differences are exact enough
  if (bounds.empty()) return glm::vec3(0);
  const glm::vec3 center = bounds.center(), half = bounds.size() * 0.5f;
  const float extent = std::max({half.x, half.y, half.z});
  const float away = std::max({std::abs(center.x), std::abs(center.y), std::abs(center.z)});
  return away > kFar * extent && std::isfinite(away) ? center : glm::vec3(0);
}

MeshStore::MeshStore(const Gl& gl)
    : gl_(gl), instances_(make_buffer(gl)), sorted_indices_(make_buffer(gl)), commands_(make_buffer(gl)) {
  // Colour of meshes without colours: w is 0. Arrays of three components have w = 1, those of four 2 + alpha.
  gl.VertexAttrib4f(kColor, 0, 0, 0, 0);
  gl.VertexAttrib4f(kFogDepth, -1, 0, 0, 0);
}

const MeshStore::Slice* MeshStore::find(const std::shared_ptr<const vrml::Mesh>& mesh) {
  Entry& entry = entries_[mesh.get()];
  // If the mesh has expired, the entry belonged to another mesh at this address.
  if (entry.mesh.expired()) {
    release(entry);
    entry.mesh = mesh;
    upload(*mesh, entry);
  }
  return entry.drawable ? &entry.slice : nullptr;
}

void MeshStore::forget_unused() {
  for (auto entry = entries_.begin(); entry != entries_.end();) {
    if (entry->second.mesh.expired()) {
      release(entry->second);
      entry = entries_.erase(entry);
    } else {
      ++entry;
    }
  }
}

void MeshStore::release(Entry& entry) {
  if (!entry.drawable) return;
  entry.drawable = false;
  std::unique_ptr<Page>& page = pages_[entry.slice.page];
  page->free_vertices.give_back(static_cast<std::size_t>(entry.slice.base_vertex), entry.vertices);
  page->free_indices.give_back(entry.slice.first_index, static_cast<std::size_t>(entry.slice.index_count));
  if (--page->meshes == 0) {
    page.reset();
    forget_binding();
  }
}

bool MeshStore::place_in(std::uint32_t index, std::size_t vertices, std::size_t indices, Entry& entry) {
  Page& page = *pages_[index];
  const auto first_vertex = page.free_vertices.take(vertices);
  if (!first_vertex) return false;
  const auto first_index = page.free_indices.take(indices);
  if (!first_index) {
    page.free_vertices.give_back(*first_vertex, vertices);
    return false;
  }
  ++page.meshes;
  entry.slice.page = index;
  entry.slice.base_vertex = static_cast<GLint>(*first_vertex);
  entry.slice.first_index = *first_index;
  entry.slice.index_count = static_cast<GLsizei>(indices);
  entry.vertices = vertices;
  return true;
}

bool MeshStore::place(unsigned format, std::size_t vertices, std::size_t indices, Entry& entry) {
  if (vertices > kLargestShared || indices > kLargestShared * kIndicesPerVertex) {
    if (!add_page(format, vertices, indices)) return false;
    return place_in(bound_page_, vertices, indices, entry);
  }
  std::size_t largest = 0;  // vertices of the largest page with this format; the next page is twice as large
  for (std::uint32_t i = 0; i < pages_.size(); ++i) {
    if (!pages_[i] || pages_[i]->format != format || pages_[i]->vertices > kLargestPage) continue;
    largest = std::max(largest, pages_[i]->vertices);
    if (place_in(i, vertices, indices, entry)) return true;
  }
  std::size_t capacity = std::clamp(largest * 2, kSmallestPage, kLargestPage);
  capacity = std::max({capacity, vertices, (indices + kIndicesPerVertex - 1) / kIndicesPerVertex});
  if (!add_page(format, capacity, capacity * kIndicesPerVertex)) return false;
  return place_in(bound_page_, vertices, indices, entry);
}

/// Makes a page and binds it. Returns false if the driver has too little memory.
bool MeshStore::add_page(unsigned format, std::size_t vertices, std::size_t indices) {
  auto page = std::make_unique<Page>();
  page->format = format;
  page->vertices = vertices;
  page->indices = indices;
  page->free_vertices = RangeAllocator(vertices);
  page->free_indices = RangeAllocator(indices);
  page->vertex_array = make_vertex_array(gl_);
  page->vertex_buffer = make_buffer(gl_);
  page->index_buffer = make_buffer(gl_);
  const Layout arrays = layout(format, vertices);

  take_errors(gl_);
  gl_.BindVertexArray(page->vertex_array.name());
  bound_page_ = kNoPage;
  gl_.BindBuffer(GL_ELEMENT_ARRAY_BUFFER, page->index_buffer.name());
  gl_.BufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(indices * sizeof(std::uint32_t)), nullptr,
                 GL_STATIC_DRAW);
  gl_.BindBuffer(GL_ARRAY_BUFFER, page->vertex_buffer.name());
  gl_.BufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(arrays.bytes), nullptr, GL_STATIC_DRAW);
  if (gl_.GetError() != GL_NO_ERROR) return false;
  for (std::size_t i = 0; i < arrays.count; ++i) {
    const ArrayPlace& array = arrays.arrays[i];
    gl_.EnableVertexAttribArray(array.location);
    gl_.VertexAttribPointer(array.location, array.components, GL_FLOAT, GL_FALSE, 0, offset_pointer(array.offset));
  }
  for (GLuint i = 0; i < kInstanceVectors; ++i) {
    gl_.EnableVertexAttribArray(kFirstInstance + i);
    gl_.VertexAttribDivisor(kFirstInstance + i, 1);
  }
  point_at_instances(0);

  std::size_t place = 0;
  while (place < pages_.size() && pages_[place]) ++place;
  if (place == pages_.size()) pages_.emplace_back();
  pages_[place] = std::move(page);
  bound_page_ = static_cast<std::uint32_t>(place);
  return true;
}

void MeshStore::point_at_instances(std::size_t first) {
  gl_.BindBuffer(GL_ARRAY_BUFFER, instances_.name());
  for (GLuint i = 0; i < kInstanceVectors; ++i)
    gl_.VertexAttribPointer(kFirstInstance + i, 4, GL_FLOAT, GL_FALSE, sizeof(Instance),
                            offset_pointer(first * sizeof(Instance) + i * 4 * sizeof(float)));
}

void MeshStore::upload(const vrml::Mesh& mesh, Entry& entry) {
  const PhaseScope phase(gl_.phases, Phase::upload);
  const std::size_t vertices = mesh.positions.size(), indices = mesh.indices.size();
  constexpr std::size_t kMax = std::numeric_limits<GLint>::max();
  if (vertices == 0 || indices == 0 || vertices > kMax || indices > kMax || !indices_in_range(mesh)) return;
  Slice& slice = entry.slice;
  slice.normals = mesh.normals.size() == vertices;
  slice.colors = mesh.colors.size() == vertices;
  slice.texture_coordinates = mesh.texture_coordinates.size() == vertices;
  const auto fits = [&](const vrml::CoordinateSet& set) { return set.size() == vertices; };
  if (mesh.coordinate_sets.size() <= vrml::kMaxCoordinateSets &&
      std::all_of(mesh.coordinate_sets.begin(), mesh.coordinate_sets.end(), fits))
    slice.coordinate_sets = static_cast<std::uint8_t>(mesh.coordinate_sets.size());
  slice.fog_depths = mesh.fog_depths.size() == vertices;
  slice.opacities = slice.colors && mesh.opacities.size() == vertices;
  slice.primitive = mesh.primitive == vrml::Mesh::Primitive::lines    ? GL_LINES
                    : mesh.primitive == vrml::Mesh::Primitive::points ? GL_POINTS
                                                                      : GL_TRIANGLES;
  slice.order = next_order_++;
  slice.origin = local_origin(mesh.bounds);
  std::vector<glm::vec3> local;
  if (slice.origin != glm::vec3(0)) {
    local.assign(mesh.positions.begin(), mesh.positions.end());
    for (glm::vec3& position : local) position -= slice.origin;
  }
  std::vector<glm::vec4> colors;
  if (slice.opacities) {
    colors.reserve(vertices);
    for (std::size_t i = 0; i < vertices; ++i) {
      const vrml::Color& color = mesh.colors[i];
      const float opacity = mesh.opacities[i];
      colors.push_back({color.r, color.g, color.b, 2 + (opacity >= 0 ? std::min(opacity, 1.0f) : 0)});
    }
  }
  const unsigned format = (slice.normals ? kNormals : 0) | (slice.colors ? kColors : 0) |
                          (slice.texture_coordinates ? kTextureCoordinates : 0) | (slice.opacities ? kOpacities : 0) |
                          (slice.fog_depths ? kFogDepths : 0) | kFirstSet * slice.coordinate_sets;
  if (!place(format, vertices, indices, entry)) return;

  uploaded_ += vertices * sizeof(glm::vec3) + indices * sizeof(std::uint32_t);
  const Page& page = *pages_[slice.page];
  gl_.BindVertexArray(page.vertex_array.name());
  bound_page_ = slice.page;
  gl_.BindBuffer(GL_ARRAY_BUFFER, page.vertex_buffer.name());
  const Layout arrays = layout(format, page.vertices);
  for (std::size_t i = 0; i < arrays.count; ++i) {
    const std::size_t stride = static_cast<std::size_t>(arrays.arrays[i].components) * sizeof(float);
    gl_.BufferSubData(
        GL_ARRAY_BUFFER,
        static_cast<GLintptr>(arrays.arrays[i].offset + static_cast<std::size_t>(slice.base_vertex) * stride),
        static_cast<GLsizeiptr>(vertices * stride),
        arrays.arrays[i].location == kPosition && !local.empty() ? static_cast<const void*>(local.data())
        : arrays.arrays[i].location == kColor && !colors.empty() ? colors.data()
                                                                 : bytes_of(mesh, arrays.arrays[i].location));
  }
  gl_.BufferSubData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLintptr>(slice.first_index * sizeof(std::uint32_t)),
                    static_cast<GLsizeiptr>(indices * sizeof(std::uint32_t)), mesh.indices.data());
  entry.drawable = true;
}

void MeshStore::set_instances(const std::vector<Instance>& instances) {
  const PhaseScope phase(gl_.phases, Phase::upload);
  gl_.BindBuffer(GL_ARRAY_BUFFER, instances_.name());
  gl_.BufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(instances.size() * sizeof(Instance)), instances.data(),
                 GL_STREAM_DRAW);
}

void MeshStore::set_sorted_indices(const std::vector<std::uint32_t>& indices) {
  const PhaseScope phase(gl_.phases, Phase::upload);
  gl_.BindBuffer(GL_ARRAY_BUFFER, sorted_indices_.name());
  gl_.BufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(indices.size() * sizeof(std::uint32_t)), indices.data(),
                 GL_STREAM_DRAW);
}

void MeshStore::set_streamed(std::span<const StreamedVertex> vertices, std::span<const std::uint32_t> indices) {
  const PhaseScope phase(gl_.phases, Phase::upload);
  const bool fresh = !streamed_;
  if (fresh)
    streamed_ = std::make_unique<Streamed>(Streamed{make_vertex_array(gl_), make_buffer(gl_), make_buffer(gl_)});
  gl_.BindVertexArray(streamed_->vertex_array.name());
  bound_page_ = kStreamedPage;
  gl_.BindBuffer(GL_ELEMENT_ARRAY_BUFFER, streamed_->indices.name());
  gl_.BufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(indices.size_bytes()), indices.data(),
                 GL_STREAM_DRAW);
  gl_.BindBuffer(GL_ARRAY_BUFFER, streamed_->vertices.name());
  gl_.BufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(vertices.size_bytes()), vertices.data(), GL_STREAM_DRAW);
  if (!fresh) return;
  const auto point_at = [&](GLuint location, GLint components, std::size_t offset) {
    gl_.EnableVertexAttribArray(location);
    gl_.VertexAttribPointer(location, components, GL_FLOAT, GL_FALSE, sizeof(StreamedVertex), offset_pointer(offset));
  };
  point_at(kPosition, 3, offsetof(StreamedVertex, position));
  point_at(kTextureCoordinate, 2, offsetof(StreamedVertex, texture_coordinate));
  point_at(kColor, 3, offsetof(StreamedVertex, color));
  for (GLuint i = 0; i < kInstanceVectors; ++i) {
    gl_.EnableVertexAttribArray(kFirstInstance + i);
    gl_.VertexAttribDivisor(kFirstInstance + i, 1);
  }
  point_at_instances(0);
}

void MeshStore::bind(const Slice& slice) {
  const std::uint32_t page = slice.streamed ? kStreamedPage : slice.page;
  if (bound_page_ == page) return;
  gl_.BindVertexArray(slice.streamed ? streamed_->vertex_array.name() : pages_[page]->vertex_array.name());
  bound_page_ = page;
}

void MeshStore::draw(const Slice& slice, std::size_t first, std::size_t count) {
  bind(slice);
  if (slice.sorted) gl_.BindBuffer(GL_ELEMENT_ARRAY_BUFFER, sorted_indices_.name());
  const void* indices = offset_pointer(slice.first_index * sizeof(std::uint32_t));
  if (gl_.DrawElementsInstancedBaseVertexBaseInstance) {
    gl_.DrawElementsInstancedBaseVertexBaseInstance(slice.primitive, slice.index_count, GL_UNSIGNED_INT, indices,
                                                    static_cast<GLsizei>(count), slice.base_vertex,
                                                    static_cast<GLuint>(first));
  } else {
    point_at_instances(first);
    gl_.DrawElementsInstancedBaseVertex(slice.primitive, slice.index_count, GL_UNSIGNED_INT, indices,
                                        static_cast<GLsizei>(count), slice.base_vertex);
  }
  if (slice.sorted)
    // Restore the index buffer of the page's vertex array.
    gl_.BindBuffer(GL_ELEMENT_ARRAY_BUFFER, pages_[slice.page]->index_buffer.name());
}

void MeshStore::draw_many(const Slice& any, std::span<const Command> commands) {
  bind(any);
  if (any.sorted) gl_.BindBuffer(GL_ELEMENT_ARRAY_BUFFER, sorted_indices_.name());
  gl_.BindBuffer(GL_DRAW_INDIRECT_BUFFER, commands_.name());
  gl_.BufferData(GL_DRAW_INDIRECT_BUFFER, static_cast<GLsizeiptr>(commands.size_bytes()), commands.data(),
                 GL_STREAM_DRAW);
  gl_.MultiDrawElementsIndirect(any.primitive, GL_UNSIGNED_INT, nullptr, static_cast<GLsizei>(commands.size()), 0);
  gl_.BindBuffer(GL_DRAW_INDIRECT_BUFFER, 0);
  if (any.sorted) gl_.BindBuffer(GL_ELEMENT_ARRAY_BUFFER, pages_[any.page]->index_buffer.name());
}

}  // namespace gs::render
