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

/// What pictures of a world are drawn with, by the options; of their size.
[[nodiscard]] render::DrawOptions picture_draw(const Options& options, const View& seen);

/// How files are seen, by the options.
[[nodiscard]] ViewStyle view_style(const Options& options);
/// The camera of --camera or --orbit, which follows --up where that is given; none where neither is asked for.
[[nodiscard]] std::optional<render::Camera> camera_of_options(const Options& options, const render::RenderList& list);
/// What is wrong with options of the camera that are right one by one.
[[nodiscard]] std::optional<std::string> check_camera(const Options& options);

/// The options with the size in pixels of what is printed. What is wrong, if anything.
[[nodiscard]] std::optional<std::string> settle_size(Options& options);

/// Of the series that a path names, the file that shows at a time; the path itself where it names none. A message where
/// the series has no file.
[[nodiscard]] std::optional<std::string> settle_series(const Options& options, double time, std::string& path);

[[nodiscard]] VolumeWishes volume_wishes(const Options& options);

}  // namespace gs::app
