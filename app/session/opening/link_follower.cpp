#include "app/session/opening/link_follower.h"

#include <algorithm>
#include <utility>

namespace gs::app {

void LinkFollower::follow_anchors(std::size_t pane) {
  WorldRuntime& world = *viewports_.panes().at(pane).view()->document->runtime;
  for (const vrml::NodePlace& anchor : world.execution().pointing().take_requests()) {
    if (vrml::SceneGraph* const scene = world.execution().scenes().own(*anchor.scene);
        scene && world.requests().open_computed_anchor(*scene, anchor.node))
      return;
    const Link link = link_of(*anchor.scene, anchor.node);
    follow(pane, link);
    return;  // stop after one link, because it leaves this world
  }
}

void LinkFollower::enter(Pane& pane) {
  View* seen = pane.view();
  const std::string* const entry = opening_.entry_of(pane.shown);
  if (!entry || !seen || !seen->document->runtime) return;
  if (const auto index = find_viewpoint(seen->list->viewpoints, *entry)) {
    // Enter as if it were the first Viewpoint of the file, without an animation (VRML97 6.53).
    camera_.go_to_viewpoint(*seen, *index);
    if (seen->navigation.transition) seen->navigation.pose = seen->navigation.transition->to;
    seen->navigation.transition.reset();
  } else
    step_.notify("No Viewpoint \"" + *entry + "\" in this world", true);
  opening_.forget_entry(pane.shown);
}

void LinkFollower::follow(std::size_t pane, const Link& link) {
  const View* seen = viewports_.panes().at(pane).view();
  for (std::size_t i = 0; i < link.places.size(); ++i) {
    const Link::Place& place = link.places[i];
    if (!place.problem.empty()) {
      step_.notify(place.problem, true);
      continue;
    }
    if (place.target.empty() || (seen && place.target == seen->document->world.path)) {
      if (!seen) continue;
      return show_viewpoint(pane, place.viewpoint);
    }
    if (step_.simulated) return;  // in simulated time, open no other worlds and no web pages
    if (place.for_browser) {
      step_.frame.web_pages.push_back(place.target);
      return;
    }
    return open(pane, link, i);
  }
}

// Moves the viewer of a viewport to a Viewpoint of its world.
void LinkFollower::show_viewpoint(std::size_t pane, const std::string& viewpoint) {
  View& seen = *viewports_.panes().at(pane).view();
  const auto index = find_viewpoint(seen.list->viewpoints, viewpoint);
  if (!index) return step_.notify("No Viewpoint \"" + viewpoint + "\" in this world", true);
  travel_.leave(pane, seen);
  camera_.jump_to_viewpoint(seen, *index);
}

// Opens the world at index `number` of a link. Uses another viewport if the link names another window.
void LinkFollower::open(std::size_t pane, const Link& link, std::size_t number) {
  const Link::Place& place = link.places[number];
  viewports_.activate(pane);
  if (link.other_window) {
    if (viewports_.panes().visible().size() == 1) viewports_.choose_layout(ViewportLayout::two);
    const std::vector<std::size_t> sight = viewports_.panes().visible();
    const auto mine = std::find(sight.begin(), sight.end(), pane);
    if (sight.size() > 1 && mine != sight.end())
      viewports_.activate(sight[(static_cast<std::size_t>(mine - sight.begin()) + 1) % sight.size()]);
  }
  if (!place.viewpoint.empty()) opening_.enter_at(place.target, place.viewpoint);
  Link rest = link;
  rest.other_window = false;  // the next URLs open in the viewport that is chosen here
  rest.places.erase(rest.places.begin(), rest.places.begin() + static_cast<std::ptrdiff_t>(number + 1));
  fallback_urls_[place.target] = std::move(rest);
  // Open the file without granting permission to read it, because only the user may grant it.
  viewports_.panes().open(std::vector<std::string>{place.target});
}

void LinkFollower::note_opened(const std::string& path, Document& document) {
  if (const auto opener = private_files_.find(path); opener != private_files_.end() && document.runtime)
    document.runtime->requests().assume_private(opener->second);
  fallback_urls_.erase(path);
}

bool LinkFollower::has_fallback(const std::string& path) const {
  const auto rest = fallback_urls_.find(path);
  return rest != fallback_urls_.end() && !rest->second.places.empty();
}

void LinkFollower::follow_fallback(std::size_t pane, const std::string& path) {
  opening_.forget_entry(path);
  if (auto rest = fallback_urls_.extract(path)) follow(pane, rest.mapped());
}

void LinkFollower::take_script_news(Document& document) {
  bool told = false;
  for (ScriptMessage& message : document.runtime->programs().take_messages()) {
    told = true;
    if (message.printed) message.diagnostic.file = "print";
    document.world.diagnostics.add(std::move(message.diagnostic));
  }
  if (told) log_.note(document.world.path, document.world.diagnostics);
  for (const ScriptRequest& request : document.runtime->requests().take_script_requests()) serve(document, request);
}

// If a Script of `document` has read a private file, marks the worlds that it opens as private too. Their names may
// reveal the content of the file.
void LinkFollower::keep_private(const Document& document, const Link& link) {
  if (!document.runtime || document.runtime->requests().private_file().empty()) return;
  for (const Link::Place& place : link.places) {
    if (place.target.empty()) continue;
    private_files_[place.target] = document.runtime->requests().private_file();
    if (const auto known = viewports_.panes().documents().document(place.target); known && known->runtime)
      known->runtime->requests().assume_private(document.runtime->requests().private_file());
  }
}

// Serves a request in a viewport that shows the world; in the active viewport if that shows it.
std::optional<std::string> LinkFollower::serve(const Document& document, const ScriptRequest& request) {
  Panes& panes = viewports_.panes();
  const auto shows = [&](std::size_t pane) {
    const View* const seen = panes.at(pane).view();
    return seen && seen->document.get() == &document;
  };
  std::size_t pane = panes.active();
  if (!shows(pane))
    for (const std::size_t other : panes.visible())
      if (shows(other)) pane = other;
  if (!shows(pane)) return std::nullopt;
  View& seen = *panes.at(pane).view();
  switch (request.kind) {
    case ScriptRequest::Kind::description:
      step_.notify(request.text, false);
      return std::nullopt;
    case ScriptRequest::Kind::viewpoint:
      if (const auto index = find_viewpoint(seen.list->viewpoints, request.text))
        camera_.jump_to_viewpoint(seen, *index);
      return std::nullopt;
    case ScriptRequest::Kind::load_url: {
      Link link = link_of(request.urls, request.parameters, *request.origin, request.source);
      // Web pages open only within this time (seconds) after a click or key. Otherwise the user did not request them.
      constexpr double kAfterPress = 3;
      if (step_.now - pressed_at_ > kAfterPress)
        for (Link::Place& place : link.places)
          if (place.for_browser) place.problem = place.target + ": not opened without a recent click";
      keep_private(document, link);
      if (request.from_client || document.controlled) keep_to_readable_files(link, *request.origin, load_.allowed);
      follow(pane, link);
      const auto may_open = [](const Link::Place& place) { return place.problem.empty(); };
      if (link.places.empty() || std::any_of(link.places.begin(), link.places.end(), may_open)) return std::nullopt;
      return link.places.front().problem;
    }
    case ScriptRequest::Kind::program:
    case ScriptRequest::Kind::create_from_url:
      return std::nullopt;  // the world itself serves these requests
  }
  return std::nullopt;
}

}  // namespace gs::app
