#include "app/settings/app_state.h"

#include <catch2/catch.hpp>

#include <string>
#include <vector>

namespace gs::app::app_state_test {

TEST_CASE("writes remembered state and reads it back") {
  AppState memory;
  for (int i = 0; i < 60; ++i) note_recent(memory, "/worlds/" + std::to_string(i) + ".wrl");
  note_recent(memory, "/worlds/30.wrl");
  note_recent(memory, "https://host/a.qnv?X-Amz-Signature=secret");
  CHECK(memory.recent.size() == AppState::kMaxRecent);
  CHECK(memory.recent[0] == "/worlds/30.wrl");
  CHECK(memory.recent[1] == "/worlds/59.wrl");
  memory.width = 1280;
  memory.height = 800;
  memory.place = {-20, 300};
  memory.areas = {200, 300.5, 0};
  memory.panels = {{"log", "bottom", true, true}, {"transfer-function", "left", false, false}};
  const auto back = read_memory(memory_text(memory));
  REQUIRE(back);
  CHECK(*back == memory);
}

TEST_CASE("writes bookmarks and reads them back") {
  const std::vector<Bookmark> bookmarks = {{"/a.wrl", "Roof", "A: Roof", {}},
                                           {"http://example.org/b.wrl", "", "B", {1, 2, 3, 0, 0, 0, 1}}};
  const auto back = read_bookmarks(bookmarks_text(bookmarks));
  REQUIRE(back);
  CHECK(*back == bookmarks);
}

TEST_CASE("writes a window's files and reads them back") {
  const SessionMemory session{{"/a.wrl", "/b.qnv"}};
  CHECK(read_session(session_text(session)) == session);
  const SessionMemory split{{"/a.wrl", "/b.qnv"}, "1:2|(2/4)", {{1, "/a.wrl", 1}, {2, "", 1}, {4, "/b.qnv", 2.5}}};
  CHECK(read_session(session_text(split)) == split);
  // The file may have any content.
  const auto spoilt = read_session(
      "{\"files\": [\"/a.wrl\"], \"split\": 7, \"viewports\": [3, {\"number\": -1}, {\"number\": 1e99}, {\"number\": "
      "2, "
      "\"file\": [], \"weight\": \"x\"}]}");
  REQUIRE(spoilt);
  CHECK(spoilt->split.empty());
  CHECK(spoilt->viewports == std::vector<SessionMemory::Viewport>{{2, "", 0}});
}

TEST_CASE("uses the intact part of a damaged file") {
  CHECK_FALSE(read_memory("no JSON"));
  CHECK_FALSE(read_memory("[1, 2]"));
  CHECK_FALSE(read_bookmarks("{\"bookmarks\": 7}"));
  const auto memory = read_memory(
      "{\"recent\": [1, \"/a.wrl\", \"\", \"/a.wrl\", \"two\\nlines\", null], \"window\": {\"width\": -5, \"height\": "
      "1e99, \"place\": [1, 1e99]}, \"areas\": [\"x\", 1e99, 250, 4, 5], \"panels\": [7, {\"panel\": \"log\", "
      "\"open\": "
      "true}, {}]}");
  REQUIRE(memory);
  CHECK(memory->recent == std::vector<std::string>{"/a.wrl"});
  CHECK(memory->width == 0);
  CHECK(memory->height == 0);
  CHECK_FALSE(memory->place);
  CHECK(memory->areas == std::array<double, 3>{0, 0, 250});
  REQUIRE(memory->panels.size() == 1);
  CHECK(memory->panels[0].open);
  const auto bookmarks =
      read_bookmarks("{\"bookmarks\": [{\"place\": \"\"}, {\"place\": \"/a\", \"camera\": [1]}, 4]}");
  REQUIRE(bookmarks);
  REQUIRE(bookmarks->size() == 1);
  CHECK(bookmarks->front().title == "/a");
  CHECK(bookmarks->front().camera.empty());
}

TEST_CASE("writes bookmarks without the signatures of presigned URLs") {
  const std::string text = bookmarks_text(
      {{"https://s3.example.org/b/a.qnv?X-Amz-Algorithm=A&X-Amz-Signature=secret&versionId=3", "A", "", {}}});
  CHECK(text.find("secret") == std::string::npos);
  const auto back = read_bookmarks(text);
  REQUIRE(back);
  CHECK(back->front().place == "https://s3.example.org/b/a.qnv?versionId=3");
}

TEST_CASE("survives any bytes in remembered state") {
  AppState memory;
  note_recent(memory, "/worlds/\xFF\xFE.wrl");  // no UTF-8
  const std::string text = memory_text(memory);
  for (std::size_t i = 0; i < text.size(); i += 3) {
    std::string spoilt = text;
    spoilt[i] = static_cast<char>(i * 31);
    (void)read_memory(spoilt);
    (void)read_bookmarks(spoilt);
    (void)read_session(text.substr(0, i));
  }
  CHECK_FALSE(read_memory(std::string(200'000, '[')));
}

}  // namespace gs::app::app_state_test
