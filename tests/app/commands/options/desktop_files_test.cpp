#include "app/commands/options/desktop_files.h"

#include "app/commands/options/options.h"
#include "app/formats/content_types.h"
#include "tests/app/run_program.h"
#include "tests/app/scratch_folder.h"

#include <catch2/catch.hpp>

#include <string>

namespace gs::app::desktop_files_test {

std::string made(std::string_view name) {
  for (const DesktopFile& file : desktop_files())
    if (file.name == name) return file.make();
  FAIL(name);
  return {};
}

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

bool there_is(const std::string& program) { return run_shell("command -v " + program).status == 0; }

TEST_CASE("lists every file type in the desktop entry, the thumbnailer and the MIME types") {
  const std::string mime = made("mime"), entry = made("entry"), thumbnailer = made("thumbnailer");
  for (const ContentType& type : content_types()) {
    INFO(type.name << " " << type.mime);
    // Other programs keep the types that only an ambiguous file name indicates.
    const bool told = has(mime, "type=\"" + std::string(type.mime) + "\"");
    CHECK((told || type.belongs_to_others || type.name == "raw voxels" || type.name == "points"));
    CHECK(has(entry, std::string(type.mime) + ";") == told);
    CHECK(has(thumbnailer, std::string(type.mime) + ";") == told);
  }
  for (const char* part : {"<glob pattern=\"*.wrl\"/>", "value=\"#VRML V2.0\"", "<alias type=\"x-world/x-vrml\"/>",
                           "<glob pattern=\"*.gslink\"/>", "value=\"NRRD000\"", "value=\"\\x89QNV\\r\\n\\x1a\\n\""})
    CHECK(has(mime, part));
  for (const char* part : {"*.img", "*.raw", "*.hdr", "*.vol", "*.xyz"})
    CHECK_FALSE(has(mime, "\"" + std::string(part)));
  CHECK(has(entry, "application/dicom;"));
  CHECK_FALSE(has(entry, "image/tiff"));
  CHECK(has(entry, "Exec=ghostspace --reuse %U\n"));
  CHECK(has(entry, "x-scheme-handler/ghostspace;"));
  CHECK(has(thumbnailer, "--snapshot %o %i\n"));
}

TEST_CASE("writes desktop files that the desktop's own tools accept, if they are installed") {
  const ScratchFolder folder;
  const struct {
    const char *name, *file, *tool, *arguments;
  } rows[] = {{"entry", "org.ghostspace.GhostSpace.desktop", "desktop-file-validate", ""},
              {"metainfo", "org.ghostspace.GhostSpace.metainfo.xml", "appstreamcli", "validate --no-net"},
              {"mime", "org.ghostspace.GhostSpace.xml", "xmllint", "--noout"},
              {"bash", "ghostspace.bash", "bash", "-n"},
              {"zsh", "_ghostspace", "zsh", "-n"},
              {"fish", "ghostspace.fish", "fish", "--no-execute"}};
  for (const auto& row : rows) {
    const std::string file = folder.write(row.file, made(row.name));
    if (!there_is(row.tool)) {
      WARN(std::string("skipped: ") + row.tool + " is not installed");
      continue;
    }
    const Run result = run_shell(std::string(row.tool) + " " + row.arguments + " " + quoted(file));
    INFO(row.name << "\n" << result.output);
    CHECK(result.status == 0);
  }
}

TEST_CASE("completes every option and command of the tables in shells") {
  const std::string bash = bash_completion(), zsh = zsh_completion(), fish = fish_completion();
  for (const CommandRow& command : command_rows().subspan(1))
    for (const std::string& text : {bash, zsh, fish}) CHECK(has(text, std::string(command.name)));
  for (const OptionRow& row : option_rows()) {
    if (row.former) {
      CHECK_FALSE(has(bash + zsh + fish, std::string(row.name) + " "));
      continue;
    }
    CHECK(has(bash, std::string(row.name)));
    CHECK(has(zsh, "'" + std::string(row.repeats ? "*" : "") + std::string(row.name) + "["));
    CHECK(has(fish, " -l " + std::string(row.name.substr(2)) + " "));
  }
}

TEST_CASE("completes commands, their options, words and files in bash") {
  const ScratchFolder folder;
  const std::string script = folder.write("completion", bash_completion());
  folder.write("d/world.wrl", "");
  folder.write("d/packed.STL.gz", "");
  folder.write("d/other.txt", "");
  folder.write("d/inner/x", "");
  const auto completed = [&](const std::string& words, int word) {
    return run_shell("cd " + quoted(folder.path("d")) + " && bash -c 'source " + script +
                     "; compopt() { :; }; COMP_WORDS=(" + words + "); COMP_CWORD=" + std::to_string(word) +
                     "; _ghostspace; printf \"%s \" \"${COMPREPLY[@]}\"'")
        .output;
  };
  CHECK(completed("ghostspace ser", 1) == "serve ");
  CHECK(completed("ghostspace check --scr", 2) == "--scripts ");
  CHECK(completed("ghostspace --scr", 1).find("--scripts") == std::string::npos);
  CHECK(completed("ghostspace --headlight o", 2) == "on off ");
  CHECK(completed("ghostspace --splats c", 2) == "cpu ");
  CHECK(completed("ghostspace encode --method o", 3) == "octree outlines ");
  CHECK(completed("ghostspace encode --keep-mesh \"\"", 3) == "none exact ");
  CHECK(completed("ghostspace --size 1", 2) == " ");
  CHECK(completed("ghostspace check w", 2) == "world.wrl ");
  const std::string all = completed("ghostspace info \"\"", 2);
  for (const char* name : {"inner ", "packed.STL.gz ", "world.wrl "}) CHECK(has(all, name));
  CHECK_FALSE(has(all, "other"));
  CHECK(completed("ghostspace --allow \"\"", 2) == "inner ");
}

// Line of a zsh terminal after each argument but the first, followed by a tab.
constexpr const char* kZshTerminal = R"(zmodload zsh/zpty
zpty z zsh -f -i
zpty -w z "PROMPT=; fpath=($1 \${(M)fpath:#*/Completion(|/Base|/Unix|/Zsh)}); autoload -Uz compinit; compinit -u -D; show() { print -r -- \"<<\$BUFFER>>\" }; zle -N show; bindkey '^I' complete-word; bindkey '^X' show; print re''ady"
while zpty -r z line; do [[ $line == *ready* ]] && break; done
shift
for typed in "$@"; do
  zpty -w -n z $'\x15'"$typed"$'\t\x18'
  while zpty -r z line; do [[ $line == *'<<'*'>>'* ]] && { print -r -- "${${line#*<<}%%>>*}"; break }; done
done
)";

TEST_CASE("completes commands, their options, words and files in zsh, if it is installed") {
  if (!there_is("zsh")) {
    WARN("skipped: zsh is not installed");
    return;
  }
  const ScratchFolder folder;
  folder.write("functions/_ghostspace", zsh_completion());
  const std::string terminal = folder.write("terminal.zsh", kZshTerminal);
  folder.write("d/world.wrl", "");
  folder.write("d/wide.txt", "");
  folder.write("d/packed.STL.gz", "");
  folder.write("d/inner/x", "");
  const std::pair<const char*, const char*> rows[] = {{"ghostspace ser", "ghostspace serve "},
                                                      {"ghostspace check --scr", "ghostspace check --scripts "},
                                                      {"ghostspace --scr", "ghostspace --scr"},
                                                      {"ghostspace --splats c", "ghostspace --splats cpu "},
                                                      {"ghostspace --display wi", "ghostspace --display wireframe "},
                                                      {"ghostspace check w", "ghostspace check world.wrl "},
                                                      {"ghostspace info p", "ghostspace info packed.STL.gz "},
                                                      {"ghostspace --allow i", "ghostspace --allow inner/"}};
  std::string command = "cd " + quoted(folder.path("d")) + " && timeout 30 zsh -f " + quoted(terminal) + " " +
                        quoted(folder.path("functions")),
              expected;
  for (const auto& [typed, completed] : rows) {
    command += " " + quoted(typed);
    expected += std::string(completed) + "\n";
  }
  CHECK(run_shell(command).output == expected);
}

TEST_CASE("completes commands, their options, words and files in fish, if it is installed") {
  if (!there_is("fish")) {
    WARN("skipped: fish is not installed");
    return;
  }
  const ScratchFolder folder;
  const std::string script = folder.write("ghostspace.fish", fish_completion());
  folder.write("d/world.wrl", "");
  folder.write("d/inner/x", "");
  // The first words of the completions.
  const auto completed = [&](const std::string& line) {
    return run_shell("cd " + quoted(folder.path("d")) + " && HOME=" + quoted(folder.path("d")) +
                     " fish --no-config -c \"source " + script + "; complete -C '" + line +
                     "'\" | cut -f 1 | tr '\\n' ' '")
        .output;
  };
  CHECK(completed("ghostspace ser") == "serve ");
  CHECK(completed("ghostspace check --scr") == "--scripts ");
  CHECK_FALSE(has(completed("ghostspace --scr"), "--scripts"));
  CHECK(completed("ghostspace --headlight o") == "off on ");
  CHECK(completed("ghostspace --display wi") == "wireframe ");
  CHECK(completed("ghostspace --stereo s") == "side-by-side ");
  CHECK(completed("ghostspace check w") == "world.wrl ");
  CHECK(completed("ghostspace --allow i") == "inner/ ");
}

TEST_CASE("desktop prints the desktop files, and lists their names") {
  CHECK(run("desktop entry").output == made("entry"));
  const Run wrong = run("desktop nothing");
  CHECK(wrong.status == 2);
  CHECK(has(wrong.output, "entry, mime, thumbnailer"));
}

}  // namespace gs::app::desktop_files_test
