#include "app/loading/world_loading.h"
#include "app/session/documents/documents.h"
#include "app/session/viewports/view.h"
#include "tests/app/scratch_folder.h"

#include <catch2/catch.hpp>

#include <string>

namespace gs::app::preview_test {

TEST_CASE("moves in a world during its loading as NavigationInfo defines (6.29)") {
  const ScratchFolder folder;
  std::string text = "#VRML V2.0 utf8\nNavigationInfo { type \"EXAMINE\" }\nViewpoint { position 0 0 10 }\n";
  text += "Shape { geometry Box { } }\n";
  while (text.size() < 10'000'000) text += "Transform { translation 1 2 3 children Group { } }\n";
  const std::string path = folder.write("a.wrl", text);
  LoadOptions options;
  WorldLoading loading(path, options);
  std::shared_ptr<Document> preview;
  while (!loading.done() && !preview) {
    (void)loading.step(std::chrono::milliseconds(10));
    if (!loading.changed() || loading.done()) continue;
    render::RenderList list = loading.collect({0, 0, 10});
    if (!list.items.empty()) preview = preview_document(path, loading, std::move(list));
  }
  REQUIRE(preview);
  CHECK(preview->has_navigation_info);
  const View view = view_of(preview, {640, 480}, {});
  CHECK(view.navigation.mode == NavigationMode::examine);
  CHECK_FALSE(view.rules.allows(NavigationMode::walk));
}

}  // namespace gs::app::preview_test
