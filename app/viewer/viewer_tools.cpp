#include "app/viewer/viewer_tools.h"

#include "app/base/temporary_file.h"
#include "app/picture/paint.h"
#include "app/picture/picture_clipboard.h"
#include "app/picture/picture_marks.h"
#include "app/picture/screenshot.h"
#include "app/picture/volume_show.h"
#include "app/view/values/picked_values.h"
#include "app/view/values/transfer_file.h"
#include "app/view/values/value_text.h"
#include "base/text.h"
#include "net/files/file.h"
#include "qnv/sampling/volume/volume_values.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <iterator>
#include <span>
#include <utility>

namespace gs::app {
namespace {

constexpr float kClick = 4;      // pixels; max movement of the pointer between press and release of a click
constexpr float kSliceEdge = 6;  // pixels; max distance from the edge of a slice at which it can be dragged

double seconds_since_1970() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

}  // namespace

ViewerTools::ViewerTools(const ViewerOptions& options, render::Renderer& renderer)
    : options_(options), renderer_(renderer), folder_(pictures_folder()) {}

bool ViewerTools::take_values() {
  const bool due = steps_.playing && std::chrono::steady_clock::now() >= steps_.next;
  const bool any = values_.take() || due;
  probe_due_ = probe_due_ || any;
  return any;
}

bool ViewerTools::take(const SessionInput::Event& given, const View* seen, const Viewport& place) {
  const WindowEvent& event = given.event;
  using Kind = WindowEvent::Kind;
  if (event.kind == Kind::pointer) {
    pointer_ = event.pointer;
    probe_due_ = true;
  }
  if (event.kind == Kind::button_down) pressed_ = event.pointer;
  if (event.kind == Kind::focus_lost) grip_.reset();
  if (event.kind == Kind::button_up && event.button == MouseButton::left && std::exchange(grip_, std::nullopt))
    return true;
  if (event.kind == Kind::button_down && event.button == MouseButton::left && !given.over_interface && !measuring_ &&
      seen) {
    pointer_ = event.pointer;
    grip_ = slice_under_pointer(*seen, place);
    if (grip_) return true;
  }
  const bool click = event.kind == Kind::button_up && event.button == MouseButton::left && !given.over_interface &&
                     glm::length(event.pointer - pressed_) < kClick;
  if (!click || !measuring_ || !seen) return false;
  if (ruled_.lock() != seen->document) ruler_.clear();
  ruled_ = seen->document;
  const glm::vec2 at = event.pointer - glm::vec2(place.left, place.top), size(place.size());
  const Ray ray = ray_through(seen->navigation.pose, at, size);
  if (const auto hit = picker_.pick(shown(kMaxViewports, *seen), ray, pick_options(*seen, size)))
    (void)ruler_.add(hit->point);
  return false;
}

std::optional<SliceGrip> ViewerTools::slice_under_pointer(const View& seen, const Viewport& place) {
  const auto world_from_node = world_from_volume(*seen.list);
  if (!seen.slices.any() || !world_from_node) return std::nullopt;
  const ViewerValues::Values& values = values_.of(seen);
  if (!values.grid) return std::nullopt;
  return slice_at_edge(*values.grid, seen.slices, *world_from_node, seen.navigation.pose, glm::vec2(place.size()),
                       pointer_ - glm::vec2(place.left, place.top), kSliceEdge);
}

// Adds the state of the slices, and the corners of the slice with an edge under the pointer, which the interface
// highlights.
void ViewerTools::describe_slices(UiTools& tools, const View& seen, const Viewport& place) {
  tools.slices = seen.slices;
  const std::optional<SliceGrip> grip = grip_ ? grip_ : slice_under_pointer(seen, place);
  const auto world_from_node = world_from_volume(*seen.list);
  if (!grip || !world_from_node) return;
  for (const glm::dvec3& corner : slice_corners(*values_.of(seen).grid, seen.slices, grip->axis)) {
    const glm::dvec3 world(*world_from_node * glm::dvec4(corner, 1));
    const auto pixel = pixel_that_sees(seen.navigation.pose, world, glm::vec2(place.size()));
    if (!pixel) return tools.slice_edge.clear();
    tools.slice_edge.push_back(*pixel + glm::vec2(place.left, place.top));
  }
}

std::optional<ColorBar> ViewerTools::bar_of(const View& seen) {
  if (const qnv::Description* const volume = first_volume(*seen.list))
    return shown_color_bar(*volume, seen.look.transfer, seen.slices, seen.volume);
  const auto& key = seen.document->world.color_key;
  return key ? std::optional(color_bar_of(*key)) : std::nullopt;
}

std::shared_ptr<const render::RenderList> ViewerTools::guides(const View& view) {
  return view.style.grid ? grids_.of(view.list->bounds, upright_of(view)) : nullptr;
}

// Applies the options of the command line for volumes, once to each opened document. Shows images as planes.
void ViewerTools::show_as_wished(View& seen, const Tell& tell) {
  const VolumeWishes& wishes = options_.volume;
  const qnv::Description* const volume = first_volume(*seen.list);
  const auto image = volume && wishes.slices.empty() ? image_axis(*volume) : std::nullopt;
  if (!volume || !(wishes.any() || image)) return;
  std::erase_if(wished_, [](const Wished& one) { return one.of.expired(); });
  auto known =
      std::find_if(wished_.begin(), wished_.end(), [&](const Wished& one) { return one.of.lock() == seen.document; });
  if (known == wished_.end()) {
    wished_.push_back({seen.document});
    known = std::prev(wished_.end());
    seen.color_bar = seen.color_bar || wishes.color_bar;
    if (!wishes.transfer.empty()) {
      auto transfer = named_transfer(wishes.transfer, *volume);
      if (auto* problem = std::get_if<std::string>(&transfer))
        tell(*problem, true);
      else
        seen.look.transfer = std::move(std::get<Transfer>(transfer));
    }
    const bool has_values = streamed_values(*seen.list) || has_volume_values(seen.document->world.path);
    known->all = wishes.slices.empty() && !(image && has_values);
    if (!known->all || wishes.display.needs_values()) apply_display(wishes, seen.volume, seen.slices);
    if (seen.volume.needs_values() && !has_values) {
      seen.volume = {};
      tell(std::string(kValuesNeeded), true);
    }
  }
  if (known->all) return;
  const ViewerValues::Values& values = values_.of(seen);
  if (!values.grid && values.problem.empty()) return;
  known->all = true;
  if (!values.grid) return tell("Slices: " + values.problem, true);
  for (const SliceWish& wish : wishes.slices) gs::app::apply(wish, values.grid->whole(), seen.slices);
  if (image) show_image(*values.grid, *image, seen.slices);
}

// Determines the value under the pointer. For a volume, it is the value at the visible depth, on a slice or surface;
// for a stream, the value of the nearest vector; for another surface, the value that its colour stands for.
void ViewerTools::probe(const View& seen, const Viewport& place) {
  value_.clear();
  const glm::vec2 at = pointer_ - glm::vec2(place.left, place.top), size(place.size());
  if (at.x < 0 || at.y < 0 || at.x >= size.x || at.y >= size.y) return;
  const render::RenderList& list = shown(kMaxViewports, seen);
  const Ray ray = ray_through(seen.navigation.pose, at, size);
  const qnv::Description* const volume = first_volume(*seen.list);
  if (volume && seen.volume.mode != VolumeMode::vectors && !seen.volume.surface && !seen.slices.any())
    return probe_projection(seen, ray, *volume);
  const auto hit = picker_.pick(list, ray, pick_options(seen, size));
  if (!hit) return;
  const auto world_from_node = world_from_volume(*seen.list);
  const auto& key = seen.document->world.color_key;
  if (volume && hit->splat && !asked_is_volume_) {
    const render::SplatItem& item = list.splats[*hit->splat];
    const glm::dvec3 inside(glm::inverse(item.world_from_node) * glm::dvec4(hit->point, 1));
    const auto* vectors = item.geometry->as<qnv::Volume>();
    if (const auto near = vectors ? value_near(*vectors, inside) : std::nullopt)
      value_ =
          "about " + readable_value(near->value, value_unit(*volume), 3) + ", from the nearest vector of the stream\n";
  } else if (!volume && key && hit->stream_color) {
    const glm::vec3& color = *hit->stream_color;
    value_ = (key->title.empty() ? "" : key->title + ": ") + "about " +
             readable_value(key->value_of({color.r, color.g, color.b}), {}, 3) + ", from the colour of the stream\n";
  } else if (!volume && key && !hit->splat && hit->item < list.items.size()) {
    if (const auto& mesh = list.items[hit->item].mesh)
      if (const auto value = value_on(*key, *mesh, hit->triangle))
        value_ = (key->title.empty() ? "" : key->title + ": ") + readable_value(*value, {}, 4) + "\n";
  } else if (volume && world_from_node) {
    values_.note_pointed(seen, hit->point);
    const ViewerValues::Values& values = values_.of(seen);
    if (values.grid) {
      const glm::dvec3 voxel =
          values.grid->voxel_at(glm::dvec3(glm::inverse(*world_from_node) * glm::dvec4(hit->point, 1)));
      if (const auto color = values.grid->color_at(voxel))
        value_ = color_text(*color) + " at " + voxel_text(*values.grid, voxel) + "\n";
      else if (const auto value = values.grid->nearest(voxel))
        value_ = (values.grid->layout().labels ? label_text(values.grid->label_of(*value))
                                               : readable_value(static_cast<double>(*value), value_unit(*volume)) +
                                                     accuracy_text(values.grid->error_at(voxel))) +
                 " at " + voxel_text(*values.grid, voxel) + "\n";
    }
  }
  value_ += place_text(hit->point);
}

// Determines the projected value on a ray.
void ViewerTools::probe_projection(const View& seen, const Ray& ray, const qnv::Description& volume) {
  const auto world_from_volume = gs::app::world_from_volume(*seen.list);
  const auto& grid = values_.of(seen).grid;
  const VolumeModeRow& mode = volume_modes()[static_cast<std::size_t>(seen.volume.mode)];
  if (!grid || !world_from_volume) return;
  const auto projected =
      projected_value(*grid, seen.volume.mode, glm::inverse(*world_from_volume), ray.origin, glm::dvec3(ray.direction));
  if (!projected) return;
  value_ = std::string(mode.label) + " on the ray: " + readable_value(projected->value, value_unit(volume));
  if (projected->voxel) value_ += " at " + voxel_text(*grid, *projected->voxel);
}

void ViewerTools::describe_volume(UiTools& tools, const View& seen, const qnv::Description& volume) {
  const bool is_stream = streamed_values(*seen.list) != nullptr;
  if (asked_.lock() != seen.document || (is_stream && !asked_is_volume_)) {
    asked_ = seen.document;
    asked_is_volume_ = is_stream || has_volume_values(seen.document->world.path);
  }
  tools.volume = seen.volume;
  if (const auto times = ViewerValues::times_of(seen); !times.empty()) {
    tools.times.assign(times.begin(), times.end());
    tools.volume.step = ViewerValues::step_of(seen);
    tools.steps_playing = steps_.playing && steps_.of.lock() == seen.document;
    tools.step_rate = steps_.rate;
  }
  tools.unit = value_unit(volume);
  tools.has_file = asked_is_volume_;
  if (!tools.has_file) return;
  const bool waits = std::any_of(wished_.begin(), wished_.end(),
                                 [&](const Wished& one) { return !one.all && one.of.lock() == seen.document; });
  const bool derives = wants_histogram_ || seen.volume.needs_values();
  if (!derives && !wants_value_ && !seen.slices.any() && !waits) return;
  const ViewerValues::Values& values = values_.of(seen);
  if (values.grid) tools.dimensions = values.grid->whole();
  if (derives) {
    tools.histogram = values_.histogram_of(seen);
    tools.isovalue = values_.isovalue_of(seen);
  }
  if (seen.volume.share != kUsualShare)
    tools.vectors = qnv::shared_as<qnv::Volume>(first_volume_geometry(shown(kMaxViewports, seen)));
  tools.reading = !values.grid && values.coming.valid();
  tools.slices_problem = values_.problem_of(seen);
}

void ViewerTools::describe(UiTools& tools, const View* seen, const Viewport& place) {
  tools.picture = wish_;
  tools.folder = folder_;
  if (export_)
    tools.exporting =
        static_cast<float>(export_->next) / static_cast<float>(std::max<std::size_t>(export_->steps.size(), 1));
  tools.measuring = measuring_;
  if (!seen) return;
  const glm::vec2 size(place.size()), corner(place.left, place.top);
  if (ruled_.lock() == seen->document) {
    for (const glm::dvec3& point : ruler_.points()) {
      auto pixel = pixel_that_sees(seen->navigation.pose, point, size);
      tools.points.push_back(pixel ? std::optional(*pixel + corner) : std::nullopt);
    }
    for (std::size_t i = 0; i + 1 < ruler_.points().size(); ++i)
      tools.legs.push_back(readable_value(ruler_.length_of(i)));
    tools.measured_text = ruler_.text();
  }
  // Points that were measured in another document are not shown.
  tools.measured = (ruled_.lock() == seen->document ? ruler_ : Ruler()).summary();
  tools.tour = toured_.lock() == seen->document ? tour_.size() : 0;
  const qnv::Description* const volume = first_volume(*seen->list);
  if (volume) describe_volume(tools, *seen, *volume);
  describe_slices(tools, *seen, place);
  if (std::exchange(probe_due_, false) && wants_value_) probe(*seen, place);
  tools.value = value_;
  tools.color_bar = seen->color_bar;
  tools.bar = bar_of(*seen);
}

PictureScene ViewerTools::scene_of(std::size_t slice_scene, const View& seen, const glm::ivec2& size,
                                   const PictureRequest& request) {
  PictureScene scene;
  scene.list = &shown(slice_scene, seen);
  scene.camera = camera_of(seen.navigation.pose);
  scene.unit = seen.scale;
  scene.draw.width = size.x;
  scene.draw.height = size.y;
  scene.draw.samples = options_.samples;
  scene.draw.background = options_.background;
  scene.draw.splats = options_.splats;
  scene.draw.headlight = seen.headlight;
  scene.draw.unit = static_cast<float>(seen.scale);
  scene.draw.splat_style = seen.look;
  scene.draw.splat_style.reading = reading_of(seen);
  apply_style(seen, scene.draw);
  scene.draw.guides = guides(seen);
  scene.draw.viewport = kMaxViewports;
  if (const auto bar = request.color_bar ? bar_of(seen) : std::nullopt)
    scene.over = [bar = *bar](render::Image& band, int top, const glm::ivec2& all) {
      draw_color_bar({band, top}, all, bar);
    };
  return scene;
}

glm::ivec2 ViewerTools::size_of(const Viewport& place) const {
  return wish_.of_window ? glm::ivec2(place.size()) * wish_.scale : wish_.size;
}

void ViewerTools::take_picture(const View& seen, const Viewport& place, const Tell& tell) {
  const render::Camera camera = camera_of(seen.navigation.pose);
  // A larger picture of the window has the same layout.
  if (!wish_.of_window) lay_out(seen, camera, glm::vec2(wish_.size));
  const PictureScene scene = scene_of(kMaxViewports, seen, size_of(place), wish_.request);
  auto picture = paint_png(renderer_, scene, wish_.request);
  if (!wish_.of_window) lay_out(seen, camera, seen.size);
  if (const auto* problem = std::get_if<std::string>(&picture))
    return tell("Cannot save the picture: " + *problem, true);
  std::error_code error;
  std::filesystem::create_directories(folder_, error);
  const LoadedWorld& world = seen.document->world;
  const std::string path = free_path(
      folder_, picture_name(world.title.empty() ? file_label(world.path) : world.title, seconds_since_1970()));
  remove_unfinished_beside(path);
  if (const auto problem = net::write_file_atomically(path, std::get<std::vector<std::byte>>(picture)))
    return tell("Cannot save the picture: " + path + ": " + problem->message, true);
  tell("Picture saved: " + path, false);
}

void ViewerTools::copy_picture(const View& seen, const Viewport& place, const Tell& tell) {
  PictureRequest request;
  request.color_bar = seen.color_bar;
  const PictureScene scene = scene_of(kMaxViewports, seen, glm::ivec2(place.size()), request);
  const auto picture = paint_png(renderer_, scene, request);
  if (const auto* problem = std::get_if<std::string>(&picture))
    return tell("Cannot copy the picture: " + *problem, true);
  if (const auto problem = copy_png(std::get<std::vector<std::byte>>(picture)))
    return tell("Cannot copy the picture: " + *problem, true);
  tell("Copied the picture", false);
}

std::vector<render::Camera>& ViewerTools::tour_of(const View& seen) {
  if (toured_.lock() != seen.document) tour_.clear();
  toured_ = seen.document;
  return tour_;
}

void ViewerTools::add_to_tour(const View& seen, const Tell& tell) {
  constexpr std::size_t kMaxViews = 1000;
  std::vector<render::Camera>& tour = tour_of(seen);
  if (tour.size() >= kMaxViews) return tell("A tour has at most 1000 views", true);
  tour.push_back(camera_of(seen.navigation.pose));
  tell("View " + std::to_string(tour.size()) + " of the tour" +
           (tour.size() == 1 ? "; File > Pictures saves the tour" : ""),
       false);
}

void ViewerTools::start_animation(const View& seen, const Viewport& place, bool of_tour, const Tell& tell) {
  Export made;
  AnimationRequest request;
  request.turntable = !of_tour;
  request.length = of_tour ? wish_.leg : wish_.seconds;
  request.rate = wish_.rate;
  if (of_tour) {
    made.tour = tour_of(seen);
    request.tour.resize(made.tour.size());
  }
  if (const auto problem = plan_animation(request, made.steps)) return tell(*problem, true);
  const bool movie = wish_.animation != AnimationFile::pictures;
  made.size = size_of(place);
  made.request = wish_.request;
  made.request.transparent = wish_.request.transparent && !movie;
  std::error_code error;
  std::filesystem::create_directories(folder_, error);
  const LoadedWorld& world = seen.document->world;
  const std::string title = world.title.empty() ? file_label(world.path) : world.title;
  const char* const end = wish_.animation == AnimationFile::webm ? ".webm" : ".mp4";
  made.path = movie ? free_path(folder_, picture_name(title, seconds_since_1970(), end))
                    : folder_ + '/' + picture_name(title, seconds_since_1970(), "");
  if (!movie) {
    for (std::size_t i = 0; (i = made.path.find('%', i)) != std::string::npos; i += 2) made.path.insert(i, 1, '%');
    made.path += ".%04d.png";
  }
  auto writer = FrameWriter::open(made.path, made.size, request.rate, made.request.dots_per_inch);
  if (auto* problem = std::get_if<std::string>(&writer)) return tell(*problem, true);
  made.writer = std::move(std::get<std::unique_ptr<FrameWriter>>(writer));
  made.of = seen.document;
  made.camera = camera_of(seen.navigation.pose);
  made.up = glm::dvec3(seen.navigation.up);
  if (!seen.list->bounds.empty()) made.center = glm::dvec3(seen.list->bounds.center());
  export_ = std::move(made);
}

bool ViewerTools::go_on(const View* seen, const Tell& tell) {
  if (!export_) return false;
  Export& job = *export_;
  std::optional<std::string> problem;
  if (!seen || job.of.lock() != seen->document) {
    problem = "another file was opened";
  } else if (job.next < job.steps.size()) {
    const AnimationStep& step = job.steps[job.next];
    const render::Camera camera = step.from && *step.from + 1 < job.tour.size()
                                      ? camera_between(job.tour[*step.from], job.tour[*step.from + 1], step.part)
                                      : turned_camera(job.camera, job.center, job.up, step.turned);
    lay_out(*seen, camera, glm::vec2(job.size));
    PictureScene scene = scene_of(kMaxViewports, *seen, job.size, job.request);
    scene.camera = camera;
    auto picture = paint_image(renderer_, scene, job.request);
    lay_out(*seen, camera_of(seen->navigation.pose), seen->size);
    if (auto* wrong = std::get_if<std::string>(&picture))
      problem = std::move(*wrong);
    else
      problem = job.writer->add(std::get<render::Image>(picture));
    ++job.next;
  }
  if (!problem && job.next >= job.steps.size()) problem = job.writer->finish();
  const std::string kind = job.tour.empty() ? "turntable" : "tour";
  if (problem) tell("The " + kind + " is incomplete: " + *problem, true);
  if (!problem && job.next >= job.steps.size())
    tell((job.tour.empty() ? "Turntable saved: " : "Tour saved: ") + job.path + " (" + job.writer->what() + ")", false);
  if (problem || job.next >= job.steps.size()) export_.reset();
  return true;
}

void ViewerTools::toggle_ruler() {
  measuring_ = !measuring_;
  if (!measuring_) ruler_.clear();
}

bool ViewerTools::close() {
  if (!measuring_ && ruler_.points().empty()) return false;
  measuring_ = false;
  ruler_.clear();
  return true;
}

void ViewerTools::apply(const UiToolActions& actions, View* seen, const Viewport& place, const Tell& tell) {
  if (actions.wants_value && !wants_value_) probe_due_ = true;
  wants_value_ = actions.wants_value;
  wants_histogram_ = actions.wants_histogram;
  if (actions.measure && *actions.measure != measuring_) toggle_ruler();
  if (actions.undo_point) (void)ruler_.undo();
  if (actions.forget_points) ruler_.clear();
  if (actions.picture) wish_ = *actions.picture;
  if (actions.cancel_export && export_) {
    tell("Animation cancelled", false);
    export_.reset();
  }
  if (!seen) return;
  show_as_wished(*seen, tell);
  if (actions.slices) seen->slices = *actions.slices;
  if (actions.volume) seen->volume = *actions.volume;
  play_steps(actions, *seen);
  if (grip_)
    seen->slices.places[grip_->axis] = dragged_place(*grip_, seen->navigation.pose, glm::vec2(place.size()),
                                                     pointer_ - glm::vec2(place.left, place.top));
  if (actions.color_bar) seen->color_bar = *actions.color_bar;
  if (actions.take_picture) take_picture(*seen, place, tell);
  if (actions.take_turntable) start_animation(*seen, place, false, tell);
  if (actions.add_to_tour) add_to_tour(*seen, tell);
  if (actions.forget_tour_view && !tour_of(*seen).empty()) tour_.pop_back();
  if (actions.take_tour) start_animation(*seen, place, true, tell);
  const qnv::Description* const volume = first_volume(*seen->list);
  if (!volume) return;
  if (actions.save_transfer) save_transfer(*actions.save_transfer, seen->look.transfer, *volume, tell);
  if (actions.load_transfer) {
    auto transfer = named_transfer(*actions.load_transfer, *volume);
    if (auto* problem = std::get_if<std::string>(&transfer)) return tell(*problem, true);
    seen->look.transfer = std::move(std::get<Transfer>(transfer));
    replaceable_transfer_ = *actions.load_transfer;
  }
}

// Begins or ends playback, and shows the next step if it is due and the one before is shown.
void ViewerTools::play_steps(const UiToolActions& actions, View& seen) {
  const std::size_t count = ViewerValues::times_of(seen).size();
  if (actions.step_rate) steps_.rate = *actions.step_rate;
  if (actions.play_steps) steps_ = {seen.document, *actions.play_steps && count > 1, steps_.rate, {}};
  if (!steps_.playing) return;
  if (steps_.of.lock() != seen.document || count < 2) {
    steps_.playing = false;
    return;
  }
  const auto now = std::chrono::steady_clock::now();
  if (now < steps_.next || !values_.shows_step(seen)) return;
  seen.volume.step = static_cast<std::uint32_t>((ViewerValues::step_of(seen) + std::size_t{1}) % count);
  steps_.next = now + std::chrono::duration_cast<std::chrono::steady_clock::duration>(
                          std::chrono::duration<double>(1 / std::max(steps_.rate, 0.01)));
}

void ViewerTools::save_transfer(const std::string& path, const Transfer& shown, const qnv::Description& volume,
                                const Tell& tell) {
  std::error_code error;
  if (path != replaceable_transfer_ && std::filesystem::exists(path, error)) {
    replaceable_transfer_ = path;
    return tell(path + " already exists; press Save again to replace it", true);
  }
  const Transfer transfer = shown.empty() ? own_transfer(volume) : shown;
  const std::string text = transfer_text(transfer, volume.value_range, value_unit(volume));
  // Create the folder that the panel proposes. A folder that the user typed must already exist.
  if (std::filesystem::path(path).parent_path() == folder_) std::filesystem::create_directories(folder_, error);
  remove_unfinished_beside(path);
  if (const auto problem = net::write_file_atomically(path, std::as_bytes(std::span(text))))
    return tell(path + ": " + problem->message, true);
  replaceable_transfer_ = path;
  tell("Saved: " + path, false);
}

}  // namespace gs::app
