#include "app/viewer/viewer_splats.h"

#include "app/inspect/selection_marks.h"
#include "net/base/url.h"
#include "net/base/url_signature.h"
#include "qnv/codecs/gaussians/lod/splat_stream.h"

#include <algorithm>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace gs::app {
namespace {

/// Returns a word of a command line, in quotes if necessary.
std::string shell_word(const std::string& word) {
  constexpr std::string_view kPlain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+=./:,%@";
  if (!word.empty() && word.find_first_not_of(kPlain) == std::string::npos) return word;
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

std::string command_of(const SplatEdit& edit, const std::string& path) {
  std::string command = "ghostspace export";
  for (const std::string& word : options_of(edit)) command += " " + shell_word(word);
  // The clipboard must not get passwords, tokens or signatures.
  const bool is_url = !net::parse_url(path).scheme.empty();
  return command + " " + shell_word(is_url ? net::url_for_messages(net::without_signature(path)) : path) + " OUT";
}

}  // namespace

bool SplatEditing::act(Session& session) {
  bool changed = false;
  for (const std::size_t pane : session.panes().visible())
    if (const View* const view = session.panes().at(pane).view())
      changed = view->document->splats.follow(*view->document, wake_) || changed;
  return changed;
}

UiSplats describe_splats(Session& session, const std::optional<Viewport>& place) {
  UiSplats splats;
  const View* const view = session.view();
  if (!view) return splats;
  Document& document = *view->document;
  const auto only = only_splats(document.world);
  if (!only) return splats;
  splats.editable = true;
  splats.edit = document.splats.edit();
  splats.extent = document.splats.extent(document.world);
  splats.removed = document.splats.removed();
  const auto& stream = only->geometry->as<qnv::Gaussians>()->stream;
  splats.shown = stream ? static_cast<std::size_t>(stream->header().vectors) : only->geometry->size();
  splats.busy = document.splats.busy();
  splats.problem = document.splats.problem();
  splats.command = command_of(splats.edit, document.world.path);
  if (!place) return splats;
  const Pose& pose = view->navigation.pose;
  const glm::dmat4 matrix = matrix_of(splats.edit);
  for (const SplatCrop& crop : splats.edit.crops) {
    std::vector<PixelLine> lines;
    if (const auto* const box = std::get_if<SplatBox>(&crop.shape)) {
      WideBox edges;
      edges.add(box->lower);
      edges.add(box->upper);
      lines = edges_of(edges, pose, *place, matrix);
    } else if (const auto* const ball = std::get_if<SplatBall>(&crop.shape)) {
      lines = circles_of(ball->center, ball->radius, pose, *place, matrix);
    }
    splats.edges.insert(splats.edges.end(), lines.begin(), lines.end());
  }
  return splats;
}

void apply_splats(const UiSplatActions& actions, Session& session) {
  const View* const view = session.view();
  if (!view || !actions.edit || !only_splats(view->document->world)) return;
  view->document->splats.set(*actions.edit, view->document->runtime->execution().now(), actions.gesture);
}

}  // namespace gs::app
