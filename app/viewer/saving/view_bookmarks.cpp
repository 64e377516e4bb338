#include "app/viewer/saving/view_bookmarks.h"

#include "app/desktop/hand_over.h"
#include "base/text.h"
#include "net/base/url_signature.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace gs::app {
namespace {

constexpr double kSameCamera = 1e-4;  // max difference between numbers of cameras that count as equal

std::vector<double> camera_numbers(const Pose& pose) {
  const auto number = [](float value) { return static_cast<double>(value); };
  std::vector<double> numbers{pose.position.x,
                              pose.position.y,
                              pose.position.z,
                              number(pose.orientation.x),
                              number(pose.orientation.y),
                              number(pose.orientation.z),
                              number(pose.orientation.w)};
  if (pose.height > 0) numbers.push_back(pose.height);
  return numbers;
}

bool are_alike(const std::vector<double>& one, const std::vector<double>& other) {
  return std::equal(one.begin(), one.end(), other.begin(), other.end(),
                    [](double a, double b) { return std::abs(a - b) <= kSameCamera * (1 + std::abs(a)); });
}

// Returns the pose for the numbers of a camera. The field of view is that of `before`.
std::optional<Pose> pose_of_camera(const std::vector<double>& camera, const Pose& before) {
  if (camera.size() != Bookmark::kCameraNumbers && camera.size() != Bookmark::kParallelNumbers) return std::nullopt;
  for (const double number : camera)
    if (!std::isfinite(number) || std::abs(number) > kFarthest) return std::nullopt;
  Pose pose = before;
  pose.position = {camera[0], camera[1], camera[2]};
  const glm::dquat orientation(camera[6], camera[3], camera[4], camera[5]);
  const double length = glm::length(orientation);
  if (!(length > 1e-6)) return std::nullopt;
  pose.orientation = glm::quat(orientation / length);
  pose.height = camera.size() == Bookmark::kParallelNumbers ? camera.back() : 0;
  return valid_pose(pose, before);
}

// Returns the path or URL for a bookmark. Removes signatures, because they are secret and expire.
std::string place_to_keep(const std::string& path) { return net::without_signature(absolute_place(path)); }

}  // namespace

std::string title_of_world(const std::string& title, const std::string& file) {
  constexpr std::size_t kMax = 100;  // max bytes of the world's title
  if (title.empty() || title == file) return file;
  return shortened(title, kMax) + " (" + file + ")";
}

// Returns a bookmark of the active viewport's Viewpoint. If the viewer has moved away from the Viewpoint, the bookmark
// also has the pose.
std::optional<Bookmark> ViewBookmarks::bookmark_of_view() const {
  const Pane& pane = session_.panes().at(session_.panes().active());
  const View* seen = pane.view();
  if (!seen || pane.shown.empty()) return std::nullopt;
  Bookmark bookmark;
  bookmark.place = place_to_keep(pane.shown);
  const auto& viewpoints = seen->list->viewpoints;
  if (seen->viewpoint && *seen->viewpoint < viewpoints.size())
    bookmark.viewpoint = viewpoint_label(viewpoints[*seen->viewpoint], *seen->viewpoint);
  if (!at_home(*seen)) bookmark.camera = camera_numbers(seen->navigation.pose);
  const std::string file = file_label(pane.shown);
  bookmark.title = title_of_world(seen->document->world.title, file);
  if (!bookmark.viewpoint.empty()) bookmark.title += ": " + shortened(bookmark.viewpoint, 80);
  return bookmark;
}

std::optional<std::size_t> ViewBookmarks::find() const {
  const auto here = bookmark_of_view();
  if (!here) return std::nullopt;
  const std::vector<Bookmark>& all = store_.bookmarks();
  for (std::size_t i = 0; i < all.size(); ++i)
    if (all[i].place == here->place && all[i].viewpoint == here->viewpoint && are_alike(all[i].camera, here->camera))
      return i;
  return std::nullopt;
}

std::string ViewBookmarks::toggle() {
  std::vector<Bookmark> kept = store_.bookmarks();
  std::string notice;
  if (const auto present = find()) {
    kept.erase(kept.begin() + static_cast<std::ptrdiff_t>(*present));
    notice = "Bookmark removed";
  } else if (auto bookmark = bookmark_of_view()) {
    notice = "Bookmarked: " + bookmark->title;
    kept.push_back(std::move(*bookmark));
  }
  store_.set(kept);
  return notice;
}

void ViewBookmarks::remove(std::size_t index) {
  std::vector<Bookmark> kept = store_.bookmarks();
  if (index >= kept.size()) return;
  kept.erase(kept.begin() + static_cast<std::ptrdiff_t>(index));
  store_.set(kept);
}

void ViewBookmarks::open(std::size_t index) {
  if (index >= store_.bookmarks().size()) return;
  const Bookmark bookmark = store_.bookmarks()[index];
  const View* seen = session_.view();
  // If the file is already open under another spelling, or with a signature, uses that spelling.
  std::string place = bookmark.place;
  for (const DocumentList::Entry& entry : session_.panes().documents().entries())
    if (place_to_keep(entry.path) == place) place = entry.path;
  session_.travel().open_at(place, bookmark.viewpoint,
                            pose_of_camera(bookmark.camera, seen ? seen->navigation.pose : Pose{}));
}

}  // namespace gs::app
