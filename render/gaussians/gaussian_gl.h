#pragma once

#include "render/gaussians/gaussian_raster.h"
#include "render/gaussians/gaussian_store.h"
#include "render/gl/gpu.h"
#include "render/scene/camera.h"
#include "render/sorting/depth_order.h"
#include "render/volume/volume_target.h"

#include <glm/vec4.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace gs::render {

/// Factor of the colours of a layer with Gaussians. The layer holds numbers from 0 to 1, but colours may exceed 1. So
/// it holds a quarter of each colour.
constexpr float kGaussianLayerGain = 4;

/// Returns the shader of DepthGlSort for Gaussians.
[[nodiscard]] std::string gaussian_keys_shader();
/// Returns the texels that describe items to the shaders. places[i] is the location of the splats of items[i].
[[nodiscard]] std::vector<glm::vec4> gaussian_item_texels(std::span<const GaussianItem> items,
                                                          std::span<const GaussianStore::Place> places);

/// Draws Gaussians with OpenGL 3.3. The image equals that of rasterize_gaussians(), except for rounding. Shaders
/// project the splats and evaluate their harmonics. A VolumeTarget blends the rectangles of all scenes, in 16 bits per
/// channel.
///
/// Compute shaders sort for each position of the eye, else a thread, perhaps for an earlier position (DepthOrder). If
/// they sort and no splat is flat, compute shaders also project each splat once. Otherwise, the vertex shader projects
/// each corner. Runs on the thread of its context.
class GaussianGl {
 public:
  explicit GaussianGl(const Gl& gl, SortMethod sort = SortMethod::automatic);

  using View = BlendedView;
  /// Prepares the drawing of `items`; held[i] owns the data of items[i]. Returns nullopt if memory or the program is
  /// missing, or if the splats cover too many pixels.
  std::optional<PreparedSplats> prepare(std::span<const std::shared_ptr<const qnv::Gaussians>> held,
                                        std::span<const GaussianItem> items, const View& view);

  /// Frees Gaussians that have no other owners. Call it once per frame.
  void forget_unused() { store_.forget_unused(); }
  /// Returns the method that sorted the last image.
  [[nodiscard]] SortMethod sorted_by() const { return order_.sorted_by(); }
  /// Reports whether compute shaders projected the splats of the last image.
  [[nodiscard]] bool projected_once() const { return rectangle_state_ == Rectangles::made; }

 private:
  /// Programs that draw: those that project have variants without and with surfels.
  enum class Drawing : std::uint8_t { project, project_surfels, read_rectangles };
  enum class Rectangles : std::uint8_t { wanted, made, impossible };
  [[nodiscard]] const Program& program(Drawing drawing);
  void set_view(const Program& program, std::size_t items, const View& view, float nearest, float farthest) const;
  [[nodiscard]] bool can_make_rectangles(std::size_t total);
  bool make_rectangles(std::size_t items, std::size_t total, const View& view);
  bool upload_items(std::span<const GaussianItem> items, std::span<const GaussianStore::Place> places);
  void draw_range(std::size_t items, std::size_t total, const View& view, const SplatRange& range);

  const Gl& gl_;
  GaussianStore store_;
  DepthOrder order_;
  std::array<Program, 3> programs_;  // by Drawing
  std::array<bool, 3> tried_programs_{};
  Program project_;  // compute shader
  bool tried_project_ = false, surfels_ = false;
  VertexArray attributes_;
  Buffer corners_, item_buffer_, rectangle_buffer_;
  Texture items_, order_texture_, rectangles_;
  std::size_t rectangle_room_ = 0;  // capacity of rectangle_buffer_, in splats
  Rectangles rectangle_state_ = Rectangles::impossible;
};

}  // namespace gs::render
