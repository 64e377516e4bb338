#include "render/mesh/mesh_pass.h"

#include <glm/glm.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

// Part of MeshPass that converts batches of items to OpenGL calls.
namespace gs::render {
namespace {

// Maximum transparent triangles of a frame that are sorted within their meshes. The meshes that are farthest stay
// unsorted.
constexpr std::size_t kMaxSorted = std::size_t{1} << 17;
// Maximum primitives of a frame. A world with USE can request more than a driver draws in a day.
constexpr std::size_t kMaxPrimitives = std::size_t{1} << 28;

std::size_t corners_of(GLenum primitive) { return primitive == GL_TRIANGLES ? 3 : primitive == GL_LINES ? 2 : 1; }

}  // namespace

// Sorts the triangles of each transparent mesh into blending order, farthest first.
void MeshPass::sort_triangles() {
  sorted_indices_.clear();
  std::size_t left = kMaxSorted;
  for (const SortKey& key : transparent_) {
    Prepared& prepared = prepared_[key.prepared];
    const vrml::Mesh& mesh = *prepared.mesh;
    const std::size_t triangles = mesh.indices.size() / 3;
    const bool hides_nothing = (mesh.convex && mesh.solid) || mesh.font_size > 0;  // text is flat
    if (prepared.slice->primitive != GL_TRIANGLES || hides_nothing || triangles < 2 || triangles > left) continue;
    left -= triangles;
    const float* row = prepared.instance.camera_from_node[2];  // the camera looks along -Z: the smallest z is farthest
    const glm::vec3 backwards(row[0], row[1], row[2]), origin = prepared.slice->origin;
    const std::uint32_t* index = mesh.indices.data();
    triangle_depths_.resize(triangles);
    for (std::size_t t = 0; t < triangles; ++t) {
      glm::vec3 sum(0);
      for (std::size_t corner = 0; corner < 3; ++corner) sum += mesh.positions[index[3 * t + corner]] - origin;
      const float depth = glm::dot(backwards, sum);
      triangle_depths_[t] = {std::isnan(depth) ? 0 : depth, static_cast<std::uint32_t>(t)};
    }
    std::sort(triangle_depths_.begin(), triangle_depths_.end());
    prepared.sorted = sorted_indices_.size();
    for (const auto& [depth, t] : triangle_depths_)
      sorted_indices_.insert(sorted_indices_.end(), index + 3 * std::size_t{t}, index + 3 * std::size_t{t} + 3);
  }
}

void MeshPass::batch(std::span<const SortKey> order, std::size_t first_instance) {
  batches_.clear();
  for (std::size_t begin = 0; begin < order.size();) {
    const SortKey& first = order[begin];
    std::size_t end = begin + 1;
    const auto joins = [&](const SortKey& key) {
      return key.layer == first.layer && key.state == first.state && key.mesh == first.mesh &&
             prepared_[key.prepared].sorted == kUnsorted;
    };
    if (prepared_[first.prepared].sorted == kUnsorted)
      while (end < order.size() && joins(order[end])) ++end;
    batches_.push_back({first.layer, first.state, static_cast<std::uint32_t>(first.mesh >> 32), first.depth,
                        first_instance + begin, end - begin, first.prepared});
    if (first.mesh == kMergedMesh) {
      Batch& merged = batches_.back();
      merged.merged = std::exchange(merged.count, 1);
      merged.first = instances_.size() - 1;
    }
    begin = end;
  }
}

/// If phases are measured, draws the first primitive of a program separately, because drivers compile for the drawing
/// state at the first draw. The caller then draws the complete instance.
void MeshPass::draw_first(const MeshStore::Slice& mesh, std::size_t& first, std::size_t& count, std::size_t primitives,
                          DrawPacer& pacer) {
  const auto corners = static_cast<GLsizei>(corners_of(mesh.primitive));
  {
    const PhaseScope phase(gl_.phases, Phase::compile);
    MeshStore::Slice one = mesh;
    one.index_count = corners;
    meshes_.draw(one, first, 1);
  }
  MeshStore::Slice rest = mesh;
  rest.first_index += static_cast<std::size_t>(corners);
  rest.index_count -= corners;
  if (primitives > 1) draw_slices(rest, primitives - 1, first, 1, pacer);
  ++first;
  --count;
}

/// Draws `count` instances of a mesh from index `first` on, in slices, until the pacer cancels.
void MeshPass::draw_slices(const MeshStore::Slice& mesh, std::size_t primitives, std::size_t first, std::size_t count,
                           DrawPacer& pacer) {
  while (count > 0 && !pacer.given_up()) {
    const std::size_t room = pacer.room();
    if (primitives <= room) {
      const std::size_t some = std::min(room / primitives, count);
      meshes_.draw(mesh, first, some);
      pacer.spend(some * primitives);
      first += some;
      count -= some;
      continue;
    }
    // One instance is too large for a slice, so draw parts of its primitives.
    const std::size_t corners = corners_of(mesh.primitive);
    MeshStore::Slice part = mesh;
    for (std::size_t drawn = 0; drawn < primitives && !pacer.given_up();) {
      const std::size_t some = std::min(pacer.room(), primitives - drawn);
      part.first_index = mesh.first_index + corners * drawn;
      part.index_count = static_cast<GLsizei>(corners * some);
      meshes_.draw(part, first, 1);
      pacer.spend(some);
      drawn += some;
    }
    ++first;
    --count;
  }
}

/// Returns the end of the batches from `first` on that one call can draw: their states and pages are equal.
std::size_t MeshPass::run_end(std::size_t first) const {
  const auto joins = [&](const Batch& batch) {
    const Prepared& prepared = prepared_[batch.prepared];
    return batch.merged == 0 && !prepared.slice->streamed;
  };
  const Batch& begin = batches_[first];
  const bool sorted = prepared_[begin.prepared].sorted != kUnsorted;
  const DrawState& state = prepared_[begin.prepared].state;
  // Layers have uniforms of each mesh. The first draw of a program is measured alone.
  if (!meshes_.draws_many() || (state.variant & kLayered) || !joins(begin)) return first + 1;
  if (const auto used = programs_.find(state.variant); gl_.phases && (used == programs_.end() || !used->second.drawn))
    return first + 1;
  const GLenum primitive = prepared_[begin.prepared].slice->primitive;
  std::size_t end = first + 1;
  while (end < batches_.size() && batches_[end].page == begin.page && batches_[end].layer == begin.layer &&
         batches_[end].state == begin.state && joins(batches_[end]) &&
         prepared_[batches_[end].prepared].slice->primitive == primitive &&
         (prepared_[batches_[end].prepared].sorted != kUnsorted) == sorted)
    ++end;
  return end;
}

/// Draws batches of equal states and pages with few calls: a call for each mesh takes a microsecond, and 20,000 take
/// longer than a frame.
void MeshPass::draw_run(std::span<const Batch> run, FrameStatistics& statistics, DrawPacer& pacer) {
  const auto slice_of = [](const Prepared& prepared) {
    MeshStore::Slice slice = *prepared.slice;
    slice.sorted = prepared.sorted != kUnsorted;
    if (slice.sorted) slice.first_index = prepared.sorted;
    return slice;
  };
  const MeshStore::Slice any = slice_of(prepared_[run.front().prepared]);
  const std::size_t corners = corners_of(any.primitive);
  std::size_t gathered = 0;  // primitives of the commands
  const auto flush = [&] {
    if (commands_.empty()) return;
    meshes_.draw_many(any, commands_);
    ++statistics.draw_calls;
    commands_.clear();
    pacer.spend(std::exchange(gathered, 0));
  };
  commands_.clear();
  for (const Batch& batch : run) {
    const MeshStore::Slice slice = slice_of(prepared_[batch.prepared]);
    const std::size_t primitives = std::max<std::size_t>(static_cast<std::size_t>(slice.index_count) / corners, 1);
    const std::size_t count = std::min(batch.count, (kMaxPrimitives - primitives_) / primitives);
    if (count == 0) continue;
    primitives_ += primitives * count;
    statistics.items += count;
    if (corners == 3) statistics.triangles += primitives * count;
    if (primitives * count > pacer.room() - std::min(gathered, pacer.room())) flush();
    if (pacer.given_up()) return;
    if (primitives * count > pacer.room()) {
      draw_slices(slice, primitives, batch.first, count, pacer);
      ++statistics.draw_calls;
      continue;
    }
    gathered += primitives * count;
    commands_.push_back({static_cast<GLuint>(slice.index_count), static_cast<GLuint>(count),
                         static_cast<GLuint>(slice.first_index), slice.base_vertex, static_cast<GLuint>(batch.first)});
  }
  flush();
}

void MeshPass::draw_batches(const Projection& projection, FrameStatistics& statistics, DrawPacer& pacer) {
  for (std::size_t i = 0; i < batches_.size(); ++i) {
    if (pacer.given_up()) return;
    const Batch& batch = batches_[i];
    const Prepared& prepared = prepared_[batch.prepared];
    if (const std::size_t end = run_end(i); end - i > 1) {
      apply(prepared.state, projection);
      draw_run(std::span(batches_).subspan(i, end - i), statistics, pacer);
      i = end - 1;
      continue;
    }
    const std::size_t corners = corners_of(prepared.slice->primitive);
    const std::size_t primitives =
        std::max<std::size_t>(static_cast<std::size_t>(prepared.slice->index_count) / corners, 1);
    const std::size_t count = std::min(batch.count, (kMaxPrimitives - primitives_) / primitives);
    if (count == 0) continue;
    primitives_ += primitives * count;
    apply(prepared.state, projection);
    if (prepared.state.variant & kLayered)
      gl_.Uniform3fv(program_of(prepared.state)->layered.mesh_origin, 1, &prepared.slice->origin.x);
    MeshStore::Slice slice = *prepared.slice;
    if (prepared.sorted != kUnsorted) {
      slice.first_index = prepared.sorted;
      slice.sorted = true;
    }
    std::size_t first = batch.first, left = count;
    if (VariantProgram& used = *program_of(prepared.state); gl_.phases && !used.drawn) {
      used.drawn = true;
      draw_first(slice, first, left, primitives, pacer);
    }
    draw_slices(slice, primitives, first, left, pacer);
    statistics.items += batch.merged > 0 ? batch.merged : count;
    ++statistics.draw_calls;
    if (corners == 3) statistics.triangles += primitives * count;
  }
}

/// Draws transparent meshes and volumes together, from back to front.
void MeshPass::draw_transparent(const Projection& projection, GLenum polygon_mode, FrameStatistics& statistics,
                                DrawPacer& pacer, bool marked) {
  const std::span<const SortKey> all(transparent_);
  std::size_t done = 0;
  const auto draw_up_to = [&](std::size_t end) {
    if (end == done) return;
    gl_.PolygonMode(GL_FRONT_AND_BACK, polygon_mode);
    gl_.Enable(GL_DEPTH_TEST);
    gl_.DepthFunc(projection.reversed ? GL_GEQUAL : GL_LEQUAL);
    gl_.Enable(GL_BLEND);
    gl_.BlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
    gl_.DepthMask(GL_FALSE);
    if (marked) gl_.Enable(GL_POLYGON_OFFSET_FILL);
    anything_applied_ = false;
    meshes_.forget_binding();
    batch(all.subspan(done, end - done), opaque_.size() + done);
    draw_batches(projection, statistics, pacer);
    styles_.end();
    gl_.Disable(GL_SAMPLE_ALPHA_TO_COVERAGE);
    gl_.Disable(GL_POLYGON_OFFSET_FILL);
    gl_.DepthMask(GL_TRUE);
    gl_.Disable(GL_BLEND);
    done = end;
  };
  for (const VolumeCaster::Cast& cast : casts_) {
    std::size_t end = done;
    while (end < all.size() && all[end].depth > cast.depth) ++end;
    draw_up_to(end);
    if (pacer.given_up()) return;
    gl_.PolygonMode(GL_FRONT_AND_BACK, GL_FILL);
    if (!volumes_->draw(cast)) {
      statistics.given_up = true;
      return;
    }
    ++statistics.items;
    ++statistics.draw_calls;
  }
  draw_up_to(all.size());
}

/// Darkens the edges of the triangles that were drawn before.
void MeshPass::draw_edges(const Projection& projection, DrawPacer& pacer) {
  constexpr float kDarker = 0.45f;
  gl_.PolygonMode(GL_FRONT_AND_BACK, GL_LINE);
  gl_.Enable(GL_BLEND);
  gl_.BlendColor(0, 0, 0, kDarker);
  gl_.BlendFuncSeparate(GL_ZERO, GL_ONE_MINUS_CONSTANT_ALPHA, GL_ZERO, GL_ONE);
  gl_.DepthMask(GL_FALSE);
  anything_applied_ = false;
  std::erase_if(batches_, [&](const Batch& one) { return prepared_[one.prepared].slice->primitive != GL_TRIANGLES; });
  const std::size_t primitives = std::exchange(primitives_, 0);
  FrameStatistics of_edges;
  draw_batches(projection, of_edges, pacer);
  styles_.end();
  primitives_ = primitives;
  gl_.DepthMask(GL_TRUE);
  gl_.Disable(GL_BLEND);
  gl_.PolygonMode(GL_FRONT_AND_BACK, GL_FILL);
}

}  // namespace gs::render
