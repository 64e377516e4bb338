#pragma once

#include <optional>
#include <string>

namespace gs::render {
struct Camera;
struct DrawOptions;
struct RenderList;
}  // namespace gs::render

namespace gs::app {

struct Options;
struct View;
struct ViewStyle;
struct VolumeWishes;

/// Returns the draw options for pictures of a world: those of the command line, for the size that they give.
[[nodiscard]] render::DrawOptions picture_draw(const Options& options, const View& seen);

/// Returns the view style of the options.
[[nodiscard]] ViewStyle view_style(const Options& options);
/// Returns the camera of --camera or --orbit, using --up if given. Returns nullopt if neither is given.
[[nodiscard]] std::optional<render::Camera> camera_of_options(const Options& options, const render::RenderList& list);
/// Checks combinations of camera options that are valid one by one. Returns the problem, or nullopt.
[[nodiscard]] std::optional<std::string> check_camera(const Options& options);

/// Sets the size in pixels from the paper size and resolution. Returns the problem, or nullopt.
[[nodiscard]] std::optional<std::string> settle_size(Options& options);

/// Replaces the name of a series in `path` by its file for `time`. Leaves any other path. Returns a message if the
/// series has no files.
[[nodiscard]] std::optional<std::string> settle_series(const Options& options, double time, std::string& path);

[[nodiscard]] VolumeWishes volume_wishes(const Options& options);

}  // namespace gs::app
