#pragma once

#include "render/image/image.h"

#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <utility>

/// Picture of the interface without a GPU or OpenGL: rasterises Dear ImGui's triangles of the last frame by pixel
/// centres, over one background colour. The 3D viewport is not drawn.
namespace gs::app::driver {

namespace interface_picture {

struct Place {
  float x, y;
};

/// Returns twice the signed area left of an edge.
inline float side(const ImVec2& a, const ImVec2& b, const Place& p) {
  return (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x);
}

/// Assigns the pixels on a common edge to exactly one triangle.
inline bool takes_edge(const ImVec2& a, const ImVec2& b) { return a.y > b.y || (a.y == b.y && a.x < b.x); }

struct Atlas {
  unsigned char* pixels = nullptr;
  int width = 0, height = 0;

  /// Returns the colour at a position, interpolated between the four nearest texels.
  [[nodiscard]] std::array<float, 4> at(float u, float v) const {
    const float x = u * static_cast<float>(width) - 0.5f, y = v * static_cast<float>(height) - 0.5f;
    const int left = static_cast<int>(std::floor(x)), top = static_cast<int>(std::floor(y));
    std::array<float, 4> sum{};
    for (int dy = 0; dy < 2; ++dy)
      for (int dx = 0; dx < 2; ++dx) {
        const int column = std::clamp(left + dx, 0, width - 1), row = std::clamp(top + dy, 0, height - 1);
        const float share =
            std::abs(x - static_cast<float>(left + 1 - dx)) * std::abs(y - static_cast<float>(top + 1 - dy));
        const unsigned char* texel = pixels + 4 * (static_cast<std::ptrdiff_t>(row) * width + column);
        for (std::size_t k = 0; k < 4; ++k) sum[k] += share * static_cast<float>(texel[k]) / 255;
      }
    return sum;
  }
};

inline void draw_triangle(render::Image& image, const Atlas& atlas, const ImVec4& clip, const ImDrawVert* corners[3]) {
  float area = side(corners[0]->pos, corners[1]->pos, {corners[2]->pos.x, corners[2]->pos.y});
  if (area == 0 || !std::isfinite(area)) return;
  if (area < 0) {
    std::swap(corners[1], corners[2]);
    area = -area;
  }
  const auto [low_x, high_x] = std::minmax({corners[0]->pos.x, corners[1]->pos.x, corners[2]->pos.x});
  const auto [low_y, high_y] = std::minmax({corners[0]->pos.y, corners[1]->pos.y, corners[2]->pos.y});
  const int left = static_cast<int>(std::max({low_x, clip.x, 0.0f})),
            top = static_cast<int>(std::max({low_y, clip.y, 0.0f}));
  const int right = static_cast<int>(std::ceil(std::min({high_x, clip.z, static_cast<float>(image.width)})));
  const int bottom = static_cast<int>(std::ceil(std::min({high_y, clip.w, static_cast<float>(image.height)})));
  const bool one_texel = corners[0]->uv.x == corners[1]->uv.x && corners[0]->uv.y == corners[1]->uv.y &&
                         corners[0]->uv.x == corners[2]->uv.x && corners[0]->uv.y == corners[2]->uv.y;
  const std::array<float, 4> flat = atlas.at(corners[0]->uv.x, corners[0]->uv.y);
  for (int y = top; y < bottom; ++y)
    for (int x = left; x < right; ++x) {
      const Place middle{static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f};
      std::array<float, 3> weights{};
      bool inside = true;
      for (std::size_t i = 0; i < 3 && inside; ++i) {
        const ImVec2 &a = corners[(i + 1) % 3]->pos, &b = corners[(i + 2) % 3]->pos;
        weights[i] = side(a, b, middle) / area;
        inside = weights[i] > 0 || (weights[i] == 0 && takes_edge(a, b));
      }
      if (!inside) continue;
      float u = 0, v = 0;
      std::array<float, 4> color{};
      for (std::size_t i = 0; i < 3; ++i) {
        u += weights[i] * corners[i]->uv.x;
        v += weights[i] * corners[i]->uv.y;
        for (std::size_t k = 0; k < 4; ++k)
          color[k] += weights[i] * static_cast<float>(corners[i]->col >> (8 * k) & 0xFF) / 255;
      }
      const std::array<float, 4> texel = one_texel ? flat : atlas.at(u, v);
      const float opacity = color[3] * texel[3];
      std::uint8_t* pixel =
          &image.pixels[3 * (static_cast<std::size_t>(y) * image.width + static_cast<std::size_t>(x))];
      for (std::size_t k = 0; k < 3; ++k)
        pixel[k] = static_cast<std::uint8_t>(
            std::lround(static_cast<float>(pixel[k]) * (1 - opacity) + 255 * color[k] * texel[k] * opacity));
    }
}

}  // namespace interface_picture

/// Returns an RGB picture of the size of the window.
inline render::Image picture_of_interface() {
  using namespace interface_picture;
  const ImGuiIO& io = ImGui::GetIO();
  render::Image image;
  image.width = static_cast<std::uint32_t>(io.DisplaySize.x);
  image.height = static_cast<std::uint32_t>(io.DisplaySize.y);
  image.components = 3;
  image.pixels.assign(std::size_t{image.width} * image.height * 3, 96);
  Atlas atlas;
  io.Fonts->GetTexDataAsRGBA32(&atlas.pixels, &atlas.width, &atlas.height);
  const ImDrawData* data = ImGui::GetDrawData();
  for (int i = 0; data && i < data->CmdListsCount; ++i) {
    const ImDrawList& list = *data->CmdLists[i];
    for (const ImDrawCmd& command : list.CmdBuffer) {
      if (command.UserCallback) continue;
      for (unsigned at = 0; at + 3 <= command.ElemCount; at += 3) {
        const ImDrawVert* corners[3];
        for (unsigned k = 0; k < 3; ++k)
          corners[k] = &list.VtxBuffer[static_cast<int>(list.IdxBuffer[static_cast<int>(command.IdxOffset + at + k)] +
                                                        command.VtxOffset)];
        draw_triangle(image, atlas, command.ClipRect, corners);
      }
    }
  }
  return image;
}

/// Returns the means of square blocks. Incomplete blocks at the right and bottom are dropped.
inline render::Image means_of_blocks(const render::Image& image, std::uint32_t side) {
  render::Image small;
  small.width = image.width / side;
  small.height = image.height / side;
  small.components = 3;
  for (std::uint32_t y = 0; y < small.height; ++y)
    for (std::uint32_t x = 0; x < small.width; ++x)
      for (std::size_t k = 0; k < 3; ++k) {
        std::uint32_t sum = 0;
        for (std::uint32_t dy = 0; dy < side; ++dy)
          for (std::uint32_t dx = 0; dx < side; ++dx)
            sum += image.pixels[3 * (std::size_t{y * side + dy} * image.width + x * side + dx) + k];
        small.pixels.push_back(static_cast<std::uint8_t>(sum / (side * side)));
      }
  return small;
}

/// Returns the share of values that differ by more than `most`, or 1 for pictures of different sizes.
inline double share_that_differs(const render::Image& a, const render::Image& b, int most) {
  if (a.width != b.width || a.height != b.height || a.pixels.size() != b.pixels.size() || a.pixels.empty()) return 1;
  std::size_t count = 0;
  for (std::size_t i = 0; i < a.pixels.size(); ++i) count += std::abs(int{a.pixels[i]} - int{b.pixels[i]}) > most;
  return static_cast<double>(count) / static_cast<double>(a.pixels.size());
}

}  // namespace gs::app::driver
