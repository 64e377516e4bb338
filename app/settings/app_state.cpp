#include "app/settings/app_state.h"

#include "net/base/url_signature.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

namespace gs::app {
namespace {

using nlohmann::json;

constexpr std::size_t kMaxStateText = 8192, kMaxBookmarks = 1000, kMaxSessionFiles = 100, kMaxPanels = 100;
constexpr int kMaxWindowPixels = 32768;

std::string printed(const json& value) { return value.dump(2, ' ', false, json::error_handler_t::replace) + "\n"; }

json parsed(std::string_view text) { return json::parse(text.begin(), text.end(), nullptr, false); }

const json& member(const json& object, const char* name) {
  static const json kNothing;
  const auto found = object.is_object() ? object.find(name) : object.end();
  return object.is_object() && found != object.end() ? *found : kNothing;
}

std::string string_in(const json& object, const char* name) {
  const json& value = member(object, name);
  if (!value.is_string()) return {};
  std::string text = value.get<std::string>();
  // Drop texts with line ends or zero bytes, which this program never writes.
  return text.size() > kMaxStateText || text.find_first_of(std::string("\n\r\0", 3)) != std::string::npos ? std::string()
                                                                                                     : text;
}

bool flag_in(const json& object, const char* name) {
  const json& value = member(object, name);
  return value.is_boolean() && value.get<bool>();
}

double number_in_json(const json& value, double least, double most) {
  if (!value.is_number()) return 0;
  const double number = value.get<double>();
  return std::isfinite(number) && number >= least && number <= most ? number : 0;
}

std::vector<std::string> strings_in(const json& list, std::size_t most) {
  std::vector<std::string> result;
  if (!list.is_array()) return result;
  for (const json& one : list) {
    const std::string text = string_in(json{{"text", one}}, "text");
    if (result.size() < most && !text.empty() && std::find(result.begin(), result.end(), text) == result.end())
      result.push_back(text);
  }
  return result;
}

}  // namespace

void note_recent(AppState& state, const std::string& place) {
  if (place.empty() || place.size() > kMaxStateText || net::is_presigned(place)) return;
  std::erase(state.recent, place);
  state.recent.insert(state.recent.begin(), place);
  if (state.recent.size() > AppState::kMaxRecent) state.recent.resize(AppState::kMaxRecent);
}

std::string memory_text(const AppState& state) {
  json panels = json::array();
  for (const PanelMemory& one : state.panels)
    panels.push_back({{"panel", one.panel}, {"side", one.side}, {"open", one.open}, {"front", one.front}});
  json window = {{"width", state.width}, {"height", state.height}};
  if (state.place) window["place"] = *state.place;
  return printed({{"recent", state.recent}, {"window", window}, {"areas", state.areas}, {"panels", panels}});
}

std::optional<AppState> read_memory(std::string_view text) {
  const json whole = parsed(text);
  if (!whole.is_object()) return std::nullopt;
  AppState state;
  state.recent = strings_in(member(whole, "recent"), AppState::kMaxRecent);
  const json& window = member(whole, "window");
  state.width = static_cast<int>(number_in_json(member(window, "width"), 64, kMaxWindowPixels));
  state.height = static_cast<int>(number_in_json(member(window, "height"), 64, kMaxWindowPixels));
  if (const json& place = member(window, "place"); place.is_array() && place.size() == 2) {
    const auto good = [](const json& one) {
      return one.is_number_integer() && std::abs(one.get<double>()) <= kMaxWindowPixels;
    };
    if (good(place[0]) && good(place[1])) state.place = {place[0].get<int>(), place[1].get<int>()};
  }
  if (const json& areas = member(whole, "areas"); areas.is_array())
    for (std::size_t i = 0; i < std::min(areas.size(), state.areas.size()); ++i)
      state.areas[i] = number_in_json(areas[i], 1, kMaxWindowPixels);
  if (const json& panels = member(whole, "panels"); panels.is_array())
    for (const json& one : panels) {
      PanelMemory panel{string_in(one, "panel"), string_in(one, "side"), flag_in(one, "open"), flag_in(one, "front")};
      if (!panel.panel.empty() && state.panels.size() < kMaxPanels) state.panels.push_back(std::move(panel));
    }
  return state;
}

std::string bookmarks_text(const std::vector<Bookmark>& bookmarks) {
  json list = json::array();
  for (const Bookmark& one : bookmarks) {
    json entry = {{"title", one.title}, {"place", net::without_signature(one.place)}};
    if (!one.viewpoint.empty()) entry["viewpoint"] = one.viewpoint;
    if (!one.camera.empty()) entry["camera"] = one.camera;
    list.push_back(std::move(entry));
  }
  return printed({{"bookmarks", list}});
}

std::optional<std::vector<Bookmark>> read_bookmarks(std::string_view text) {
  const json whole = parsed(text);
  const json& list = member(whole, "bookmarks");
  if (!list.is_array()) return std::nullopt;
  std::vector<Bookmark> bookmarks;
  for (const json& one : list) {
    Bookmark bookmark{string_in(one, "place"), string_in(one, "viewpoint"), string_in(one, "title"), {}};
    if (bookmark.place.empty() || bookmarks.size() >= kMaxBookmarks) continue;
    if (bookmark.title.empty()) bookmark.title = bookmark.place;
    const json& camera = member(one, "camera");
    if (camera.is_array() &&
        (camera.size() == Bookmark::kCameraNumbers || camera.size() == Bookmark::kParallelNumbers) &&
        std::all_of(camera.begin(), camera.end(), [](const json& number) { return number.is_number(); }))
      for (const json& number : camera) bookmark.camera.push_back(number.get<double>());
    bookmarks.push_back(std::move(bookmark));
  }
  return bookmarks;
}

std::string session_text(const SessionMemory& session) {
  json viewports = json::array();
  for (const SessionMemory::Viewport& one : session.viewports)
    viewports.push_back({{"number", one.number}, {"file", one.file}, {"weight", one.weight}});
  return printed({{"files", session.files}, {"split", session.split}, {"viewports", viewports}});
}

std::optional<SessionMemory> read_session(std::string_view text) {
  const json whole = parsed(text);
  if (!whole.is_object()) return std::nullopt;
  SessionMemory session{strings_in(member(whole, "files"), kMaxSessionFiles), string_in(whole, "split"), {}};
  if (const json& viewports = member(whole, "viewports"); viewports.is_array())
    for (const json& one : viewports) {
      const auto number = static_cast<std::size_t>(number_in_json(member(one, "number"), 1, kMaxSessionFiles));
      if (number == 0 || session.viewports.size() >= kMaxSessionFiles) continue;
      session.viewports.push_back({number, string_in(one, "file"), number_in_json(member(one, "weight"), 0, 1000)});
    }
  return session;
}

}  // namespace gs::app
