#include "app/viewer/saving/world_saver.h"

#include "app/saving/save_formats.h"
#include "app/saving/world_text.h"
#include "app/settings/user_folders.h"
#include "net/files/standard_input.h"
#include "vrml/printing/print_scene.h"

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <utility>
#include <variant>

namespace gs::app {
namespace {

namespace fs = std::filesystem;

bool is_file(const std::string& path) {
  std::error_code error;
  return path != net::kStandardInputPath && fs::is_regular_file(path, error);
}

// Returns the first properties that a format lacks, as one notice.
std::string text_of_losses(const std::vector<std::string>& losses) {
  constexpr std::size_t kShown = 3;
  std::string text = "Not saved: ";
  for (std::size_t i = 0; i < std::min(losses.size(), kShown); ++i) text += (i > 0 ? "\n" : "") + losses[i];
  return losses.size() > kShown ? text + "\nand " + std::to_string(losses.size() - kShown) + " more" : text;
}

}  // namespace

WorldSaver::WorldSaver(Parts parts, std::string not_kept, std::function<void()> close, std::function<void()> wake)
    : session_(parts.session),
      ui_(parts.ui),
      dialog_(parts.dialog),
      store_(parts.store),
      not_kept_(std::move(not_kept)),
      close_(std::move(close)),
      wake_(std::move(wake)) {}

// Returns the path that the dialog proposes: the world's own path for VRML97 and X3D, else with the extension .wrl.
// Edited splats get a new name, because no format of splats is saved in place.
std::string WorldSaver::proposed_path() const {
  const std::string& own = document_->world.path;
  std::string name = file_label(own);
  if (only_splats(document_->world))
    name = fs::path(name).stem().string() + "-edited.ply";
  else if (!is_text_path(name))
    name = fs::path(name).stem().string() + ".wrl";
  std::error_code error;
  const fs::path folder =
      own != not_kept_ && is_file(own) ? fs::absolute(own, error).parent_path() : fs::path(with_home("~"));
  return (folder / name).lexically_normal().string();
}

void WorldSaver::show_dialog() {
  const std::string path = proposed_path();
  if (!store_.settings().system_dialog || !dialog_.show_saving(path)) ui_.show_save_dialog(path, save_format_list());
}

void WorldSaver::ask_for_file() {
  const View* const seen = session_.view();
  if (!seen) return;
  document_ = seen->document;
  after_.reset();
  show_dialog();
}

void WorldSaver::ask_in_window() {
  if (document_) ui_.show_save_dialog(proposed_path(), save_format_list());
}

void WorldSaver::save_to(const std::string& typed, bool agreed) {
  if (!document_) return;
  const std::string path = path_with_format(typed);
  std::error_code error;
  if (fs::exists(path, error) && !(agreed && path == typed)) {
    replaced_ = path;
    return;
  }
  if (is_text_path(path) && !only_splats(document_->world))
    write_text(path);
  else
    start_export(path);
}

void WorldSaver::write_text(const std::string& path) {
  const auto made = world_text(*document_, path);
  if (const auto* problem = std::get_if<std::string>(&made))
    return ui_.show_notice("Cannot save " + path + ": " + *problem, true);
  const auto& text = std::get<WorldText>(made);
  if (const auto problem = write_world_text(path, text.text))
    return ui_.show_notice("Cannot save " + path + ": " + *problem, true);
  saved(path, text.left_out);
  if (!text.losses.empty()) ui_.show_notice(text_of_losses(text.losses), false);
}

void WorldSaver::start_export(const std::string& path) {
  ExportSource source;
  source.path = document_->world.path;
  const bool splats = only_splats(document_->world).has_value();
  const bool changed = !document_->edits.latest().empty();
  if (splats) source.options = options_of(document_->splats.edit());
  if (!splats && (changed || !is_file(source.path))) {
    const bool is_x3d =
        document_->world.scene && vrml::own_grammar(*document_->world.scene) == vrml::Grammar::x3d_classic;
    source.text = std::make_unique<TemporaryFile>(is_x3d ? "world.x3dv" : "world.wrl", std::span<const std::byte>());
    source.path = source.text->path();
    source.folder = fs::path(document_->world.path).parent_path().string();
    if (source.folder.empty() || !is_file(document_->world.path)) source.folder = ".";
    const auto made = world_text(*document_, source.path);
    const auto* problem = std::get_if<std::string>(&made);
    const auto unwritten =
        problem ? std::optional(*problem) : write_world_text(source.path, std::get<WorldText>(made).text);
    if (unwritten) return ui_.show_notice("Cannot save " + path + ": " + *unwritten, true);
  }
  ui_.show_notice("Saving " + path + "...", false);
  exports_.push_back(
      {std::make_unique<WorldExport>(std::move(source), path, wake_), document_, document_->splats.edit()});
  if (splats) {
    if (after_) ui_.show_notice("The splats are being saved; close again when saving is finished", false);
    after_.reset();
    return;
  }
  // The format has no fields, so the edits of the world remain unsaved.
  if (const auto after = std::exchange(after_, std::nullopt))
    ui_.show_notice("Only VRML97 and X3D keep all edits; the world is still open", false);
}

void WorldSaver::saved(const std::string& path, std::size_t left_out) {
  if (left_out == 0) document_->edits.mark_saved();
  ui_.show_notice("Saved: " + path, false);
  if (left_out > 0)
    ui_.show_notice(std::to_string(left_out) + (left_out == 1 ? " edit is" : " edits are") +
                        " not saved: the nodes belong to Inlines, prototypes or Scripts, not to this file",
                    true);
  const auto after = std::exchange(after_, std::nullopt);
  document_.reset();
  if (after && left_out == 0) proceed(*after);
}

bool WorldSaver::take_results() {
  for (Export& one : exports_)
    if (const auto result = one.running->take()) {
      ui_.show_notice(
          result->problem ? "Cannot save " + result->target + ": " + *result->problem : "Saved: " + result->target,
          result->problem.has_value());
      if (const auto document = one.document.lock(); document && !result->problem)
        document->splats.mark_saved(one.splats);
      one.running.reset();
    }
  return std::erase_if(exports_, [](const Export& one) { return !one.running; }) > 0;
}

// Questions ---------------------------------------------------------------------------------------

bool WorldSaver::is_shown_elsewhere(std::size_t pane, const std::string& path) const {
  const Panes& panes = session_.panes();
  const std::vector<std::size_t> all = panes_of(panes.split());
  return std::any_of(all.begin(), all.end(),
                     [&](std::size_t other) { return other != pane && panes.at(other).shown == path; });
}

bool WorldSaver::permits(Action action, std::size_t pane, const std::string& path) {
  const std::shared_ptr<Document> document = session_.panes().documents().document(path);
  if (!document || !document->unsaved()) return true;
  asked_ = Waiting{action, pane, path, document};
  replaced_.clear();
  return false;
}

bool WorldSaver::permits(Action action) {
  const Panes& panes = session_.panes();
  const std::size_t active = panes.active();
  if (action == Action::close_viewport) return permits(PaneRequest{PaneRequest::Kind::close, active});
  if (action == Action::reload) return permits(action, active, panes.at(active).wanted);
  if (action != Action::quit) return true;
  for (const DocumentList::Entry& entry : panes.documents().entries())
    if (std::find(discarded_.begin(), discarded_.end(), entry.document) == discarded_.end() &&
        !permits(action, active, entry.path))
      return false;
  if (exports_.empty() || std::exchange(warned_, true)) return true;
  ui_.show_notice("A file is still being saved; close the window again to stop that", false);
  return false;
}

bool WorldSaver::permits(const PaneRequest& request) {
  const Panes& panes = session_.panes();
  if (!has_pane(panes.split(), request.pane)) return true;
  const std::string& path = panes.at(request.pane).shown;
  if (request.kind == PaneRequest::Kind::open_again && !panes.at(request.pane).failure)
    return permits(Action::reload, request.pane, path);
  if (request.kind != PaneRequest::Kind::close) return true;
  if (is_shown_elsewhere(request.pane, path)) return true;
  return permits(Action::close_viewport, request.pane, path);
}

std::optional<UiQuestion> WorldSaver::question() const {
  if (!replaced_.empty() && document_)
    return UiQuestion{UiQuestion::Kind::replace, file_label(document_->world.path), replaced_, {}};
  if (asked_) return UiQuestion{UiQuestion::Kind::unsaved, file_label(asked_->document->world.path), {}, {}};
  return std::nullopt;
}

void WorldSaver::answer(UiAnswer answer) {
  if (const std::string path = std::exchange(replaced_, {}); !path.empty()) {
    if (answer == UiAnswer::save) save_to(path, true);
    return;
  }
  const auto asked = std::exchange(asked_, std::nullopt);
  if (!asked) return;
  if (answer == UiAnswer::cancel) return discarded_.clear();
  if (answer == UiAnswer::save) {
    document_ = asked->document;
    after_ = asked;
    return show_dialog();
  }
  if (asked->action == Action::quit) {
    discarded_.push_back(asked->document);
  } else {
    asked->document->edits.mark_saved();
    asked->document->splats.mark_saved(asked->document->splats.edit());
    session_.panes().reload(asked->path);
  }
  proceed(*asked);
}

void WorldSaver::proceed(const Waiting& waiting) {
  if (waiting.action == Action::quit) {
    if (permits_end()) close_();
  } else if (waiting.action == Action::reload) {
    (void)session_.input().run(Action::reload);
  } else {
    session_.input().serve(PaneRequest{PaneRequest::Kind::close, waiting.pane});
  }
}

}  // namespace gs::app
