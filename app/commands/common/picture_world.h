#pragma once

#include <optional>
#include <string>

namespace gs::render {
struct Camera;
struct DrawOptions;
struct RenderList;
}  // namespace gs::render

namespace gs::app {

struct PictureOptions;
struct View;
struct ViewStyle;

/// Returns the draw options for pictures of a world: those of the command line, for the size that they give.
[[nodiscard]] render::DrawOptions picture_draw(const PictureOptions& options, const View& seen);

/// Returns the view style of the options.
[[nodiscard]] ViewStyle view_style(const PictureOptions& options);
/// Returns the camera of --camera or --orbit, using --up if given. Returns nullopt if neither is given.
[[nodiscard]] std::optional<render::Camera> camera_of_options(const PictureOptions& options, const render::RenderList& list);
/// Checks combinations of camera options that are valid one by one. Returns the problem, or nullopt.
[[nodiscard]] std::optional<std::string> check_camera(const PictureOptions& options);

/// Sets the size in pixels from the paper size and resolution. Returns the problem, or nullopt.
[[nodiscard]] std::optional<std::string> settle_size(PictureOptions& options);

/// Replaces the name of a series in `path` by its file for `time`. Leaves any other path. Returns a message if the
/// series has no files.
[[nodiscard]] std::optional<std::string> settle_series(const PictureOptions& options, double time, std::string& path);

}  // namespace gs::app
