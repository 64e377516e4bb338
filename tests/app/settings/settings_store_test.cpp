#include "app/settings/settings_store.h"

#include "tests/app/scratch_folder.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include <sys/wait.h>
#include <unistd.h>

namespace gs::app::settings_store_test {
namespace {

namespace fs = std::filesystem;

UserFolders folders_in(const ScratchFolder& scratch) {
  return {scratch.path("config/settings.conf"), scratch.path("config/bookmarks.json"), scratch.path("state")};
}

// Returns the number of an ended process.
pid_t gone_process() {
  const pid_t child = ::fork();
  if (child == 0) ::_exit(0);
  int status = 0;
  REQUIRE(::waitpid(child, &status, 0) == child);
  return child;
}

}  // namespace

TEST_CASE("restores kept state in the next window") {
  const ScratchFolder scratch;
  {
    SettingsStore keeper(folders_in(scratch));
    UserSettings settings;
    settings.text_size = 1.5;
    keeper.set(settings);
    AppState memory;
    note_recent(memory, "/a.wrl");
    keeper.set(memory);
    keeper.set(std::vector<Bookmark>{{"/a.wrl", "", "A", {}}});
    CHECK(keeper.take_problems().empty());
  }
  SettingsStore keeper(folders_in(scratch));
  CHECK(keeper.settings().text_size == 1.5);
  CHECK(keeper.state().recent == std::vector<std::string>{"/a.wrl"});
  CHECK(keeper.bookmarks().size() == 1);
  CHECK(remembered(folders_in(scratch)).recent.size() == 1);
  // Only their owner can read the created folders.
  CHECK(fs::status(scratch.path("state")).permissions() == fs::perms::owner_all);
}

TEST_CASE("does not replace a file of bookmarks that it could not read") {
  const ScratchFolder scratch;
  const UserFolders folders = folders_in(scratch);
  const std::string contents(std::size_t{2} << 20, ' ');  // longer than a file that is read
  REQUIRE_FALSE(write_user_file(folders.bookmarks_file, contents));
  SettingsStore store(folders);
  CHECK(store.take_problems().size() == 1);
  store.set(std::vector<Bookmark>{{"/a.wrl", "", "A", {}}});
  const std::vector<std::string> problems = store.take_problems();
  REQUIRE(problems.size() == 1);
  CHECK(problems[0] == folders.bookmarks_file + ": error: not saved, because the file could not be read");
  CHECK(fs::file_size(folders.bookmarks_file) == contents.size());
  UserSettings settings;
  settings.text_size = 1.5;
  store.set(settings);  // other files are saved
  CHECK(store.take_problems().empty());
  CHECK(fs::exists(folders.settings_file));
}

TEST_CASE("removes unfinished files of killed processes from the settings folders") {
  const ScratchFolder scratch;
  const std::string left = "/.ghostspace-" + std::to_string(gone_process()) + "-0";
  scratch.write("config" + left, "theme = da");
  scratch.write("state" + left, "{");
  scratch.write("config/.ghostspace-1-0.bak", "kept");
  const SettingsStore keeper(folders_in(scratch));
  CHECK_FALSE(fs::exists(scratch.path("config" + left)));
  CHECK_FALSE(fs::exists(scratch.path("state" + left)));
  CHECK(scratch.read("config/.ghostspace-1-0.bak") == "kept");
}

TEST_CASE("reports damaged files once, keeps them, and continues") {
  const ScratchFolder scratch;
  scratch.write("config/settings.conf", "theme = light\nspeed = fast\n");
  scratch.write("config/bookmarks.json", "{{{");
  scratch.write("state/memory.json", std::string(2 << 20, 'x'));
  {
    SettingsStore keeper(folders_in(scratch));
    CHECK(keeper.settings().theme == Theme::light);
    CHECK(keeper.bookmarks().empty());
    const auto problems = keeper.take_problems();
    REQUIRE(problems.size() == 3);
    CHECK(problems[0].find("settings.conf:2: error: speed = \"fast\"") != std::string::npos);
    CHECK(problems[1].find("bookmarks.json.bad") != std::string::npos);
    CHECK(keeper.take_problems().empty());
    keeper.set(std::vector<Bookmark>{{"/a.wrl", "", "A", {}}});
  }
  CHECK(scratch.read("config/settings.conf.bad") == "theme = light\nspeed = fast\n");
  CHECK(scratch.read("config/bookmarks.json.bad") == "{{{");
  CHECK(SettingsStore(folders_in(scratch)).bookmarks().size() == 1);
}

TEST_CASE("reports a folder without write permission once") {
  const ScratchFolder scratch;
  scratch.write("config", "a file where the folder should be");
  SettingsStore keeper(folders_in(scratch));
  UserSettings settings;
  settings.text_size = 1.5;
  keeper.set(settings);
  CHECK(keeper.take_problems().size() == 1);
  CHECK(keeper.settings().text_size == 1.5);
}

TEST_CASE("offers the files of a window that ended unexpectedly once") {
  const ScratchFolder scratch;
  const std::string lost = "state/session-" + std::to_string(gone_process()) + ".json";
  scratch.write(lost, session_text({{"/a.wrl", "/b.wrl"}}));
  scratch.write("state/session-1.json", session_text({{"/of-init.wrl"}}));  // process 1 runs
  scratch.write("state/session-x.json", "{");
  {
    SettingsStore keeper(folders_in(scratch));
    CHECK(keeper.take_lost_sessions() == SessionMemory{{"/a.wrl", "/b.wrl"}});
    CHECK(keeper.take_lost_sessions().files.empty());
    CHECK_FALSE(fs::exists(scratch.path(lost)));
    keeper.note_session({{"/c.wrl"}});
    const std::string mine = "state/session-" + std::to_string(::getpid()) + ".json";
    CHECK(read_session(scratch.read(mine)) == SessionMemory{{"/c.wrl"}});
  }
  // A clean end leaves nothing to restore.
  CHECK_FALSE(fs::exists(scratch.path("state/session-" + std::to_string(::getpid()) + ".json")));
}

TEST_CASE("reads and writes nothing without folders") {
  const ScratchFolder scratch;
  SettingsStore keeper({});
  UserSettings settings;
  settings.text_size = 2;
  keeper.set(settings);
  keeper.note_session({{"/a.wrl"}});
  keeper.log("a line");
  CHECK(keeper.settings().text_size == 2);
  CHECK(keeper.take_lost_sessions().files.empty());
  CHECK(keeper.take_problems().empty());
}

TEST_CASE("limits the log on disk, and keeps its lines single") {
  const ScratchFolder scratch;
  LogFile log(scratch.path("state/log"));
  log.add("one\ntwo\x1b[2J", 200);
  const std::string first = scratch.read("state/log");
  CHECK(std::count(first.begin(), first.end(), '\n') == 1);
  CHECK(first.find("one\\ntwo\\x1b[2J") != std::string::npos);
  for (int i = 0; i < 50; ++i) log.add("a line that says little", 200);
  CHECK(scratch.read("state/log").size() < 300);
  CHECK(scratch.read("state/log.old").size() < 300);
  CHECK(scratch.read("state/log.old").size() >= 200);
}

TEST_CASE("stores settings in the desktop's folders (XDG Base Directory Specification)") {
  const auto before = [](const char* name) {
    const char* value = ::getenv(name);
    return value ? std::string(value) : std::string();
  };
  const std::string home = before("HOME"), config = before("XDG_CONFIG_HOME"), state = before("XDG_STATE_HOME");
  ::setenv("HOME", "/home/somebody", 1);
  ::unsetenv("XDG_CONFIG_HOME");
  ::setenv("XDG_STATE_HOME", "relative", 1);  // a relative path must be ignored
  UserFolders folders = user_folders();
  CHECK(folders.settings_file == "/home/somebody/.config/ghostspace/settings.conf");
  CHECK(folders.state == "/home/somebody/.local/state/ghostspace");
  ::setenv("XDG_CONFIG_HOME", "/elsewhere", 1);
  folders = user_folders();
  CHECK(folders.bookmarks_file == "/elsewhere/ghostspace/bookmarks.json");
  CHECK(user_folders("mine.conf").settings_file == "mine.conf");
  CHECK(with_home("~/a") == "/home/somebody/a");
  CHECK(with_home("~other/a") == "~other/a");
  CHECK(without_home("/home/somebody/a") == "~/a");
  CHECK(without_home("/home/somebodyelse") == "/home/somebodyelse");
  const auto restore = [](const char* name, const std::string& value) {
    if (value.empty())
      ::unsetenv(name);
    else
      ::setenv(name, value.c_str(), 1);
  };
  restore("HOME", home);
  restore("XDG_CONFIG_HOME", config);
  restore("XDG_STATE_HOME", state);
}

}  // namespace gs::app::settings_store_test
