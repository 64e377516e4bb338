#include "app/picture/volume_show.h"

#include "app/formats/volume/volume_common.h"
#include "app/picture/picture_marks.h"
#include "app/view/derived/volume_histogram.h"
#include "app/view/values/color_maps.h"
#include "app/view/values/transfer_file.h"
#include "net/files/file.h"
#include "qnv/sampling/volume/volume_values.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>
#include <variant>

namespace gs::app {

std::shared_ptr<const qnv::Geometry> first_volume_geometry(const render::RenderList& list) {
  for (const render::SplatItem& item : list.splats)
    if (item.geometry && item.geometry->as<qnv::Volume>()) return item.geometry;
  return nullptr;
}

const qnv::Description* first_volume(const render::RenderList& list) {
  const auto geometry = first_volume_geometry(list);  // the list owns it, too
  return geometry ? &geometry->description() : nullptr;
}

void apply_display(const VolumeWishes& wishes, VolumeDisplay& display, VolumeSlices& slices) {
  display = wishes.display;
  slices = wishes.slice_look;
  slices.alone = slices.alone || (display.surface && display.mode == VolumeMode::vectors);
}

std::optional<std::size_t> image_axis(const qnv::Description& volume) {
  if (volume.box.empty()) return std::nullopt;
  const glm::vec3 size = volume.box.size();
  std::optional<std::size_t> flat;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (size[static_cast<int>(axis)] >= volume.spacing / 2) continue;
    if (flat) return std::nullopt;  // a line of voxels
    flat = axis;
  }
  return flat;
}

bool has_volume_values(const std::string& path) {
  constexpr std::size_t kHeader = 1024;  // bytes with which every format begins recognisably
  std::error_code error;
  if (!zarr_entry_of_folder(path).empty() || !entry_of_folder(path).empty()) return true;
  if (!std::filesystem::is_regular_file(path, error)) return false;
  const auto opened = net::map_file(path);
  const auto* file = std::get_if<net::MappedFile>(&opened);
  return file && is_volume(path, file->bytes().first(std::min(file->bytes().size(), kHeader)));
}

void show_image(const VolumeGrid& grid, std::size_t axis, VolumeSlices& slices) {
  constexpr std::size_t kOutliers = 200;         // one value of so many is an outlier, on each side
  constexpr std::uint64_t kSampled = 1'000'000;  // max values that determine the colours
  slices.shown = {};
  slices.shown[axis] = true;
  slices.places[axis] = 0;
  slices.alone = true;
  if (slices.window) return;
  const std::uint64_t count = std::uint64_t{grid.kept(0)} * grid.kept(1) * grid.kept(2);
  const std::uint64_t step = count / kSampled + 1;
  std::vector<float> values;
  for (std::uint64_t i = 0; i < count; i += step) {
    const auto x = static_cast<std::uint32_t>(i % grid.kept(0)), row = static_cast<std::uint32_t>(i / grid.kept(0));
    const float value = grid.kept_value(x, row % grid.kept(1), row / grid.kept(1));
    if (std::isfinite(value)) values.push_back(value);
  }
  if (values.size() < 2) return;
  const auto skipped = static_cast<std::ptrdiff_t>(values.size() / kOutliers);
  const auto low = values.begin() + skipped, high = values.end() - 1 - skipped;
  std::nth_element(values.begin(), low, values.end());
  std::nth_element(low + 1, high, values.end());
  if (*low < *high) slices.window = {*low, *high};
}

std::variant<Transfer, std::string> named_transfer(const std::string& name, const qnv::Description& volume) {
  if (const ColorMap* map = find_color_map(name)) return recolored(own_transfer(volume), *map);
  const auto opened = net::map_file(name);
  if (const auto* problem = std::get_if<net::FileError>(&opened))
    return problem->message + "; expected a file or one of " + color_map_names();
  const auto bytes = std::get<net::MappedFile>(opened).bytes();
  auto file = read_transfer_file({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, name);
  if (auto* problem = std::get_if<std::string>(&file)) return std::move(*problem);
  return transfer_over(std::get<TransferFile>(file), volume.value_range);
}

ColorBar shown_color_bar(const qnv::Description& volume, const Transfer& transfer, const VolumeSlices& slices,
                         const VolumeDisplay& display) {
  ColorBar bar = color_bar_of(volume, transfer.empty() ? own_transfer(volume) : transfer);
  const bool hidden = slices.alone && (slices.any() || display.surface);
  if (hidden ? !slices.any() : display.mode == VolumeMode::vectors) return bar;
  const ColorMap* map = find_color_map(slices.map);
  bar.colors = mapped_transfer(map ? *map : color_maps().front(), OpacityRamp::flat);
  if (slices.window) bar.range = {slices.window->first, slices.window->second};
  return bar;
}

std::optional<std::string> VolumeShow::prepare(const VolumeWishes& wishes, const std::string& path,
                                               const render::RenderList& list, const std::optional<ColorKey>& key,
                                               const WorldBudget& budget) {
  wishes_ = wishes;
  const qnv::Description* const volume = first_volume(list);
  const auto streamed = streamed_values(list);
  const auto image =
      volume && wishes.slices.empty() && (streamed || has_volume_values(path)) ? image_axis(*volume) : std::nullopt;
  if (!wishes.any() && !image) return std::nullopt;
  if (!volume && key && wishes.transfer.empty() && wishes.slices.empty()) {
    surface_bar_ = color_bar_of(*key);
    return std::nullopt;
  }
  if (!volume)
    return path +
           ": has no volume; expected a volume with --transfer and --slice, and a volume or coloured values with "
           "--color-bar";
  if (!wishes.transfer.empty()) {
    auto transfer = named_transfer(wishes.transfer, *volume);
    if (auto* problem = std::get_if<std::string>(&transfer)) return std::move(*problem);
    transfer_ = std::move(std::get<Transfer>(transfer));
  }
  apply_display(wishes, display_, slices_);
  if (wishes.slices.empty() && !image && !display_.needs_values()) return std::nullopt;
  if (!streamed && !has_volume_values(path)) return path + ": " + std::string(kValuesNeeded);
  auto grid = streamed ? VolumeGrid::take(streamed->source, nullptr, budget, VolumeGrid::kMaxVoxels, streamed.get())
                       : VolumeGrid::read(path, nullptr, budget, VolumeGrid::kMaxVoxels, wishes.component);
  if (auto* problem = std::get_if<std::string>(&grid)) return std::move(*problem);
  grid_ = std::move(std::get<std::shared_ptr<const VolumeGrid>>(grid));
  for (const SliceWish& wish : wishes.slices) gs::app::apply(wish, grid_->whole(), slices_);
  if (image) show_image(*grid_, *image, slices_);
  return derive(*first_volume_geometry(list), budget);
}

// Computes the content that the display needs.
std::optional<std::string> VolumeShow::derive(const qnv::Geometry& geometry, const WorldBudget& budget) {
  const auto take = [](auto made, auto& content) -> std::optional<std::string> {
    if (auto* problem = std::get_if<std::string>(&made)) return std::move(*problem);
    content = std::move(std::get<0>(made));
    return std::nullopt;
  };
  content_.surface_color = display_.surface_color;
  content_.hides_vectors = slices_.alone && (slices_.any() || display_.surface);
  std::optional<std::string> problem;
  if (display_.surface) {
    const float isovalue = display_.isovalue.value_or(VolumeHistogram(*grid_).threshold());
    problem = take(isosurface_mesh(grid_, isovalue, budget), content_.surface);
    if (!problem && content_.surface->empty())
      problem = "no isosurface at " + readable_value(static_cast<double>(isovalue)) + "; expected a value from " +
                readable_value(static_cast<double>(grid_->value_range().first)) + " to " +
                readable_value(static_cast<double>(grid_->value_range().second));
  }
  if (problem || content_.hides_vectors) return problem;
  if (display_.mode != VolumeMode::vectors)
    return take(projection_of(*grid_, {display_.mode, slices_.window, slices_.map}, budget), content_.projection);
  if (display_.share != kUsualShare)
    return take(vectors_of_share(grid_, *geometry.as<qnv::Volume>(), display_.share, budget), content_.vectors);
  return std::nullopt;
}

render::VolumeReading VolumeShow::reading(const VolumeWishes& wishes, const render::RenderList& list) const {
  VolumeDisplay display;
  VolumeSlices slices = slices_;
  apply_display(wishes, display, slices);
  render::VolumeReading reading;
  reading.values = !wishes.slices.empty() || wishes.display.needs_values();
  reading.only_slices = !wishes.slices.empty() && slices.alone && !display.surface;
  const auto world_from_node = world_from_volume(list);
  if (grid_ && world_from_node) reading.slices = slice_planes(*grid_, slices_, *world_from_node);
  return reading;
}

void VolumeShow::apply(PictureScene& scene) {
  if (!transfer_.empty()) scene.draw.splat_style.transfer = transfer_;
  const qnv::Description* const volume = first_volume(*scene.list);
  if (wishes_.color_bar && (volume || surface_bar_)) {
    scene.over = [before = std::move(scene.over),
                  bar = volume ? shown_color_bar(*volume, transfer_, slices_, display_) : *surface_bar_](
                     render::Image& band, int top, const glm::ivec2& size) {
      if (before) before(band, top, size);
      draw_color_bar({band, top}, size, bar);
    };
  }
  const auto world_from_volume = gs::app::world_from_volume(*scene.list);
  scene.list = &slice_scene_.with_slices(*scene.list, grid_, slices_);
  if (world_from_volume) scene.list = &volume_scene_.with_content(*scene.list, *world_from_volume, content_);
}

}  // namespace gs::app
