#include "app/viewer/viewer_tools.h"
#include "base/noncopyable.h"
#include "qnv/codecs/values/encode/values_stream.h"
#include "render/gl/context.h"
#include "tests/app/interface/driver.h"
#include "tests/app/scratch_folder.h"
#include "tests/qnv/value_streams.h"
#include "tests/qnv/volume_sources.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <string>
#include <thread>
#include <vector>

// Tests of the tools of a window, drawn without one.
namespace gs::app::viewer_tools_test {
namespace {

constexpr Viewport kPlace{0, 0, 96, 64};

/// Tools of a simulated window. Pictures are stored in a folder of the test.
struct Workshop : NonCopyable {
  Workshop() {
    ::setenv("XDG_PICTURES_DIR", scratch.path("pictures").c_str(), 1);
    auto opened = render::open_headless_context("auto");
    if (auto* made = std::get_if<std::unique_ptr<render::GlContext>>(&opened)) context = std::move(*made);
    if (!context) return;
    auto created = render::Renderer::create(*context);
    if (auto* made = std::get_if<std::unique_ptr<render::Renderer>>(&created)) renderer = std::move(*made);
    if (!renderer) return;
    options.samples = 1;
    tools = std::make_unique<ViewerTools>(options, *renderer);
    ::unsetenv("XDG_PICTURES_DIR");
  }
  ~Workshop() {
    tools.reset();
    renderer.reset();
  }

  View& view() { return *user.session().view(); }
  void open(const std::string& path) {
    user.session().opening().open_files({path});
    REQUIRE(user.wait_for([&] {
      const View* const seen = user.session().view();
      return seen && seen->document->all_came && !seen->document->is_preview;
    }));
  }
  void apply(const UiToolActions& actions) {
    tools->apply(actions, &view(), kPlace, [this](const std::string& text, bool) { told.push_back(text); });
  }
  void finish() {
    while (tools->go_on(&view(), [this](const std::string& text, bool) { told.push_back(text); })) {
    }
  }
  UiTools describe() {
    UiTools described;
    tools->describe(described, &view(), kPlace);
    return described;
  }
  bool take(WindowEvent::Kind kind, const glm::vec2& pointer) {
    SessionInput::Event event;
    event.event.kind = kind;
    event.event.pointer = pointer;
    return tools->take(event, &view(), kPlace);
  }
  [[nodiscard]] std::vector<std::string> pictures(const std::string& ending) const {
    std::vector<std::string> found;
    std::error_code error;
    for (const auto& entry : std::filesystem::directory_iterator(scratch.path("pictures"), error))
      if (entry.path().extension() == ending) found.push_back(entry.path().string());
    std::sort(found.begin(), found.end());
    return found;
  }

  ScratchFolder scratch;
  driver::Driver user;
  ViewerOptions options;
  std::unique_ptr<render::GlContext> context;
  std::unique_ptr<render::Renderer> renderer;
  std::unique_ptr<ViewerTools> tools;
  std::vector<std::string> told;
};

std::string bytes_in(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// Returns a volume of 24^3 voxels in kelvins. They fall from 250 in the middle to 0.
std::string nrrd_of_warm_ball() {
  std::string volume = "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 24 24 24\nsample units: K\nencoding: ascii\n\n";
  for (int z = 0; z < 24; ++z)
    for (int y = 0; y < 24; ++y)
      for (int x = 0; x < 24; ++x)
        volume += std::to_string(std::max(0, 250 - static_cast<int>(20 * std::hypot(x - 12, y - 12, z - 12)))) + " ";
  return volume;
}

}  // namespace

TEST_CASE("saves turntables and tours of the window as pictures and movies") {
  Workshop shop;
  if (!shop.tools) return;  // nothing can draw here
  shop.user.show_world("Viewpoint { position 0 0 6 } Shape { geometry Box { size 1 2 3 } }", "a box.wrl");
  UiToolActions actions;
  PictureWish wish;
  wish.seconds = 1;
  wish.rate = 5;
  wish.leg = 1;
  actions.picture = wish;
  actions.take_turntable = true;
  shop.apply(actions);
  CHECK(shop.describe().exporting == 0.0f);
  shop.finish();
  CHECK_FALSE(shop.describe().exporting);
  const std::vector<std::string> turned = shop.pictures(".png");
  REQUIRE(turned.size() == 5);
  CHECK(bytes_in(turned[0]) != bytes_in(turned[1]));
  REQUIRE(shop.told.size() == 1);
  CHECK(shop.told[0].starts_with("Turntable saved: "));
  CHECK(shop.told[0].find("5 pictures") != std::string::npos);

  // A tour shows the added views, in a movie.
  const auto tell = [&](const std::string& text, bool) { shop.told.push_back(text); };
  shop.tools->add_to_tour(shop.view(), tell);
  CHECK(shop.describe().tour == 1);
  shop.view().navigation.pose.position = {3, 0, 6};
  shop.tools->add_to_tour(shop.view(), tell);
  actions = {};
  wish.animation = AnimationFile::mp4;
  actions.picture = wish;
  actions.take_tour = true;
  shop.apply(actions);
  shop.finish();
  INFO(shop.told.back());
  REQUIRE(shop.pictures(".mp4").size() == 1);
  CHECK(bytes_in(shop.pictures(".mp4")[0]).substr(4, 4) == "ftyp");
  CHECK(shop.told.back().starts_with("Tour saved: "));
  CHECK(shop.pictures(".png").size() == 5);

  // A cancelled animation is reported.
  actions = {};
  actions.take_turntable = true;
  shop.apply(actions);
  actions = {};
  actions.cancel_export = true;
  shop.apply(actions);
  CHECK_FALSE(shop.describe().exporting);
  CHECK(shop.told.back() == "Animation cancelled");
}

TEST_CASE("drags a slice through its volume by its edge in the picture") {
  Workshop shop;
  if (!shop.tools) return;
  std::string volume = "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 11 11 11\nencoding: ascii\n\n";
  for (int i = 0; i < 11 * 11 * 11; ++i) volume += std::to_string(i % 11 * 20) + " ";
  shop.open(shop.scratch.write("a.nrrd", volume));
  UiToolActions actions;
  VolumeSlices slices;
  slices.shown[0] = slices.alone = true;
  actions.slices = slices;
  actions.wants_value = true;
  shop.apply(actions);
  for (int i = 0; i < 5000 && shop.describe().dimensions[0] == 0; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  REQUIRE(shop.describe().dimensions[0] == 11);
  CHECK_FALSE(shop.tools->reads_values());
  const auto world = world_from_volume(*shop.view().list);
  REQUIRE(world);
  shop.view().navigation.pose.position = glm::dvec3(*world * glm::dvec4(-8, 3, 40, 1));
  shop.view().navigation.pose.orientation = glm::quat(1, 0, 0, 0);
  shop.view().navigation.transition.reset();
  const auto seen_at = [&](double x) {
    const auto pixel = pixel_that_sees(shop.view().navigation.pose, glm::dvec3(*world * glm::dvec4(x, 10.5, 5, 1)),
                                       glm::vec2(kPlace.size()));
    REQUIRE(pixel);
    return *pixel;
  };
  using Kind = WindowEvent::Kind;
  CHECK_FALSE(shop.take(Kind::pointer, {2, 2}));
  CHECK(shop.describe().slice_edge.empty());
  CHECK_FALSE(shop.take(Kind::pointer, seen_at(5)));
  CHECK(shop.describe().slice_edge.size() == 4);
  CHECK(shop.take(Kind::button_down, seen_at(5)));  // the press does not reach the session
  CHECK_FALSE(shop.take(Kind::pointer, seen_at(8)));
  shop.apply({});
  CHECK(shop.view().slices.places[0] == Approx(0.8).margin(0.02));
  CHECK(shop.take(Kind::button_up, seen_at(8)));
  CHECK_FALSE(shop.take(Kind::pointer, seen_at(2)));
  shop.apply({});
  CHECK(shop.view().slices.places[0] == Approx(0.8).margin(0.02));
  // A press beside the slice goes to the session.
  CHECK_FALSE(shop.take(Kind::button_down, {2, 2}));
  CHECK_FALSE(shop.take(Kind::button_up, {2, 2}));
}

TEST_CASE("shows an isosurface, projections and shares of a volume in the window, from other threads") {
  Workshop shop;
  if (!shop.tools) return;
  shop.open(shop.scratch.write("a.nrrd", nrrd_of_warm_ball()));
  UiToolActions actions;
  actions.wants_histogram = true;
  shop.apply(actions);
  const auto settle = [&] {
    for (int i = 0; i < 5000; ++i) {
      (void)shop.tools->shown(0, shop.view());
      (void)shop.describe();
      if (!shop.tools->reads_values()) return;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      (void)shop.tools->take_values();
    }
    FAIL("the values are not read");
  };
  const auto shown = [&](const VolumeDisplay& display) -> const render::RenderList& {
    UiToolActions change = actions;
    change.volume = display;
    shop.apply(change);
    settle();
    return shop.tools->shown(0, shop.view());
  };
  settle();
  const UiTools described = shop.describe();
  REQUIRE(described.histogram);
  CHECK(described.unit == "K");
  REQUIRE(described.isovalue);
  CHECK(*described.isovalue > 20);
  CHECK(*described.isovalue < 200);
  const render::RenderList& plain = *shop.view().list;
  CHECK(&shop.tools->shown(0, shop.view()) == &plain);
  const std::size_t items = plain.items.size(), vectors = plain.splats.at(0).geometry->size();

  VolumeDisplay display;
  display.share = 0.3f;
  CHECK(shown(display).splats.at(0).geometry->size() > 2 * vectors);
  display = {};
  display.surface = true;
  display.isovalue = 150.0f;
  REQUIRE(shown(display).items.size() == items + 1);
  CHECK_FALSE(shown(display).items.back().mesh->empty());
  CHECK(shown(display).splats.size() == 1);
  const auto before = shown(display).items.back().mesh;
  // While another surface is computed, the one of before stays.
  display.isovalue = 100.0f;
  UiToolActions change;
  change.volume = display;
  shop.apply(change);
  CHECK(shop.tools->shown(0, shop.view()).items.back().mesh == before);
  settle();
  CHECK(shop.tools->shown(0, shop.view()).items.back().mesh != before);
  shop.view().slices.alone = true;
  CHECK(shop.tools->shown(0, shop.view()).splats.empty());
  shop.view().slices.alone = false;

  display = {};
  display.mode = VolumeMode::maximum;
  CHECK(shown(display).items.back().volume);
  CHECK(shown(display).splats.empty());
  const auto world = world_from_volume(plain);
  REQUIRE(world);
  shop.view().navigation.pose.position = glm::dvec3(*world * glm::dvec4(12, 12, 60, 1));
  shop.view().navigation.pose.orientation = glm::quat(1, 0, 0, 0);
  shop.view().navigation.transition.reset();
  actions.wants_value = true;
  shop.apply(actions);
  (void)shop.take(WindowEvent::Kind::pointer, glm::vec2(kPlace.size()) / 2.0f);
  CHECK(shop.describe().value == "Maximum on the ray: 250 K at voxel 12, 12, 12");
}

TEST_CASE("asks before a saved transfer function replaces another file") {
  Workshop shop;
  if (!shop.tools) return;
  std::string volume = "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 5 5 5\nencoding: ascii\n\n";
  for (int i = 0; i < 125; ++i) volume += std::to_string(i) + " ";
  shop.open(shop.scratch.write("a.nrrd", volume));
  const std::string path = shop.scratch.write("bone.json", "mine");
  UiToolActions save;
  save.save_transfer = path;
  shop.apply(save);
  REQUIRE(shop.told.size() == 1);
  CHECK(shop.told.back().find("already") != std::string::npos);
  CHECK(bytes_in(path) == "mine");
  shop.apply(save);
  CHECK(shop.told.back() == "Saved: " + path);
  const std::string saved = bytes_in(path);
  CHECK(saved.find('{') != std::string::npos);
  // Replacing the saved file or a loaded file needs no confirmation.
  shop.apply(save);
  CHECK(shop.told.back() == "Saved: " + path);
  const std::string other = shop.scratch.write("other.json", saved);
  UiToolActions load;
  load.load_transfer = other;
  shop.apply(load);
  CHECK(shop.told.size() == 3);
  save.save_transfer = other;
  shop.apply(save);
  CHECK(shop.told.back() == "Saved: " + other);
  // A new file needs no confirmation.
  save.save_transfer = shop.scratch.path("new.json");
  shop.apply(save);
  CHECK(shop.told.back() == "Saved: " + *save.save_transfer);
}

TEST_CASE("shows the value under the pointer for surfaces of coloured values, with a bar") {
  Workshop shop;
  if (!shop.tools) return;
  shop.open(shop.scratch.write("a.inp",
                               "4 1 1 0 0\n1 -1 -1 0\n2 1 -1 0\n3 1 1 0\n4 -1 1 0\n1 1 quad 1 2 3 4\n"
                               "1 1\nheat, K\n1 10\n2 30\n3 30\n4 10\n"));
  shop.view().navigation.pose.position = {0, 0, 5};
  shop.view().navigation.pose.orientation = glm::quat(1, 0, 0, 0);
  UiToolActions actions;
  actions.wants_value = true;
  shop.apply(actions);
  const auto at = [&](const glm::dvec3& place) {
    const auto pixel = pixel_that_sees(shop.view().navigation.pose, place, glm::vec2(kPlace.size()));
    REQUIRE(pixel);
    (void)shop.take(WindowEvent::Kind::pointer, *pixel);
    shop.apply(actions);
    return shop.describe().value;
  };
  CHECK(at({0, 0.5, 0}).starts_with("heat (K): 20\n"));
  CHECK(at({0.5, -0.5, 0}).starts_with("heat (K): 25\n"));
  CHECK(at({4, 1, 0}).empty());
  const UiTools described = shop.describe();
  REQUIRE(described.bar);
  CHECK(described.bar->title == "heat (K)");
  CHECK(described.bar->range == std::pair(10.0, 30.0));
  CHECK(described.bar->colors.size() == 5);
}

TEST_CASE("shows the value of a stream's nearest vector under the pointer") {
  Workshop shop;
  if (!shop.tools) return;
  shop.open(shop.scratch.write("a.nrrd", nrrd_of_warm_ball()));
  // Now the source voxels of the vectors are missing.
  shop.view().document->world.path = shop.scratch.path("gone.qnv");
  const auto world = world_from_volume(*shop.view().list);
  REQUIRE(world);
  shop.view().navigation.pose.position = glm::dvec3(*world * glm::dvec4(12, 12, 60, 1));
  shop.view().navigation.pose.orientation = glm::quat(1, 0, 0, 0);
  shop.view().navigation.transition.reset();
  UiToolActions actions;
  actions.wants_value = true;
  shop.apply(actions);
  (void)shop.take(WindowEvent::Kind::pointer, glm::vec2(kPlace.size()) / 2.0f);
  shop.apply(actions);
  INFO(shop.describe().value);
  const std::string value = shop.describe().value;
  CHECK(value.starts_with("about "));
  CHECK(value.find(" K, from the nearest vector") != std::string::npos);
}

TEST_CASE("shows the steps of a time series by a slider, and plays them") {
  Workshop shop;
  if (!shop.tools) return;
  // Step s has the values 0 to 10 (s + 1).
  constexpr std::uint32_t kSteps = 10;
  std::vector<qnv::VolumeSource> steps;
  for (std::uint32_t s = 0; s < kSteps; ++s) {
    qnv::VolumeLayout layout;
    layout.dimensions = {24, 24, 24};
    steps.push_back(test::volume_of(layout, [s](std::uint32_t x, std::uint32_t y, std::uint32_t z) {
      const double far = std::hypot(x - 12.0, y - 12.0, z - 12.0);
      return static_cast<float>((s + 1) * std::max(0.0, 10 - far));
    }));
  }
  qnv::VolumeSource source = steps.front();
  for (std::uint32_t s = 0; s < kSteps; ++s) source.times.push_back(0.5 * s);
  source.steps = std::move(steps);
  const auto stream = test::encoded_stream(qnv::encode_values(source, {}));
  shop.open(shop.scratch.write("a.qnv",
                               std::string(reinterpret_cast<const char*>(stream.bytes.data()), stream.bytes.size())));
  const auto settle = [&] {
    for (int i = 0; i < 5000; ++i) {
      (void)shop.tools->shown(0, shop.view());
      (void)shop.tools->take_values();
      (void)shop.describe();
      if (!shop.tools->reads_values()) break;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  };
  UiToolActions actions;
  actions.wants_histogram = true;
  shop.apply(actions);
  settle();
  REQUIRE(shop.describe().times.size() == kSteps);
  CHECK(shop.describe().times[3] == 1.5);
  CHECK(shop.describe().volume.step == 0u);
  const auto values_shown = [&] { return streamed_values(shop.tools->shown(0, shop.view())); };
  for (const std::uint32_t step : {9u, 3u}) {
    UiToolActions move = actions;
    move.volume = shop.describe().volume;
    move.volume->step = step;
    shop.apply(move);
    settle();
    settle();
    CHECK(shop.describe().volume.step == step);
    REQUIRE(values_shown());
    CHECK(values_shown()->step == step);
  }
  UiToolActions play = actions;
  play.play_steps = true;
  play.step_rate = 1000;
  shop.apply(play);
  CHECK(shop.describe().steps_playing);
  CHECK(shop.tools->reads_values());
  std::set<std::uint32_t> seen;
  for (int i = 0; i < 20'000 && seen.size() < kSteps; ++i) {
    (void)shop.tools->take_values();
    shop.apply(actions);
    if (const auto values = values_shown()) seen.insert(values->step);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  CHECK(seen.size() == kSteps);
  play.play_steps = false;
  shop.apply(play);
  CHECK_FALSE(shop.describe().steps_playing);
  settle();
}

}  // namespace gs::app::viewer_tools_test
