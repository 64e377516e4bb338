// save_settings settings|bookmarks|state FILE: changes one file of the user as a window does: reads it, changes
// one value and saves it. Prints problems and then exits with 1. For scripts/checks/fault_check.py.

#include "app/settings/settings_store.h"

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace {

// Ends the program as the main program does, for example if a destructor gets no memory.
[[noreturn]] void end_at_exception() {
  std::fputs("save_settings: not enough memory\n", stderr);
  std::_Exit(1);
}

}  // namespace

int main(int count, char** arguments) try {
  using namespace gs::app;
  std::set_terminate(end_at_exception);
  if (count != 3) {
    std::fputs("usage: save_settings settings|bookmarks|state FILE\n", stderr);
    return 2;
  }
  const std::string_view kind = arguments[1];
  const std::string file = arguments[2];
  UserFolders folders;
  if (kind == "settings") folders.settings_file = file;
  if (kind == "bookmarks") folders.bookmarks_file = file;
  if (kind == "state") folders.state = std::filesystem::path(file).parent_path().string();
  int problems = 0;
  {
    SettingsStore store(folders);
    if (kind == "settings") {
      UserSettings settings = store.settings();
      settings.text_size += 0.25;
      store.set(settings);
    } else if (kind == "bookmarks") {
      std::vector<Bookmark> bookmarks = store.bookmarks();
      bookmarks.push_back({"/worlds/tower.wrl", "Entrance", "Tower", {}});
      store.set(bookmarks);
    } else {
      AppState state = store.state();
      note_recent(state, "/worlds/tower.wrl");
      store.set(state);
    }
    for (const std::string& problem : store.take_problems()) {
      std::fprintf(stderr, "%s\n", problem.c_str());
      problems = 1;
    }
  }
  return problems;
} catch (const std::exception& error) {
  std::fprintf(stderr, "save_settings: %s\n", error.what());
  return 1;
}
