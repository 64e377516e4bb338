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

/// Returns the draw options for a picture of a world, from the options of the command line and their picture size.
[[nodiscard]] render::DrawOptions picture_draw(const PictureOptions& options, const View& seen);

/// Returns the view style from the options of the command line.
[[nodiscard]] ViewStyle view_style(const PictureOptions& options);
/// Returns the camera of --camera or --orbit. --up sets its up direction. Returns nullopt without these two options.
[[nodiscard]] std::optional<render::Camera> camera_of_options(const PictureOptions& options, const render::RenderList& list);
/// Checks the camera options together. Each one alone is valid. Returns an error, or nullopt.
[[nodiscard]] std::optional<std::string> check_camera(const PictureOptions& options);

/// Computes the size in pixels from paper size and resolution. Returns an error, or nullopt.
[[nodiscard]] std::optional<std::string> settle_size(PictureOptions& options);

/// If `path` is the name of a series, replaces it by the file for `time`. Does not change other paths. Returns an error
/// if the series has no files.
[[nodiscard]] std::optional<std::string> settle_series(const PictureOptions& options, double time, std::string& path);

}  // namespace gs::app
