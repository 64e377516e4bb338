#include "tests/fuzz/scripts/script_grammar.h"

// Calls of the Browser object, of the standard and of Contact.
namespace gs::fuzz {

// Appends a call or an assignment of the Browser object of other browsers (app/script/browser/browser.cpp).
void ScriptGrammar::contact_call() {
  switch (random_.below(8)) {
    case 0:
      return line("Browser." + random_.pick({"viewpointPosition", "viewpointOrientation", "eventMask", "windowSize"}) +
                  " = " + any() + ";");
    case 1:
      return line("Browser." + random_.pick({"setViewpointByValue", "getViewpointByValue", "computeRayHit"}) + "(" +
                  vector() + ", " + vector() + ", " + any() + ");");
    case 2:
      return line("Browser." +
                  random_.pick({"setAvatarHeight", "setStepOverSize", "setCollisionDistance", "setVisibilityLimit",
                                "setWalkSpeed", "setHeadlight", "setGravity", "setCollisionDetection",
                                "setSoundEnabled", "setViewpointAnimation"}) +
                  "(" + number() + ");");
    case 3:
      return line("Browser.setNavigationMode(" + quoted(random_.pick({"WALK", "fly", "NONE", "SLIDE", "x"})) + ");");
    case 4:
      return line("Browser." + random_.pick({"addRoute", "addRoute", "deleteRoute"}) + "(Browser, " +
                  quoted(random_.pick({"event_changed", "windowAspect", "viewpointPosition"})) + ", " + node() + ", " +
                  quoted(random_.pick({"one", "go", "place", "set_translation"})) + ");");
    case 5:
      return line("Browser.addRoute(" + node() + ", " + quoted(random_.pick({"v", "translation"})) + ", Browser, " +
                  quoted("set_viewpointPosition") + ");");
    case 6:
      return line("use(Browser." +
                  random_.pick({"getScript()", "boundViewpoint", "getAvatarHeight()", "getZFar()", "viewpointPosition",
                                "getOption(s)", "setOption(s, s)", "getBaseURL()", "isKeyPressed(65)", "unknown(n)",
                                "getNavigationMode()"}) +
                  ");");
    default:
      return line("var hit = Browser.computeRayHit(" + vector() + ", " + vector() +
                  "); if (hit) { hold(hit.hitPath[0]); n = hit.hitPath[hit.hitPath.length - 1]; }");
  }
}

void ScriptGrammar::browser_call() {
  switch (random_.below(13)) {
    case 10:
    case 11:
    case 12:
      return contact_call();
    case 0:
    case 1:
      if (!nested_ && depth_ <= 2 && random_.once_in(2)) return nested_script();
      if (nested_) return line("hold(make(2));");
      return line("hold(Browser.createVrmlFromString('" + nodes_text() + "'));");
    case 2:
      return line("Browser.createVrmlFromURL(" + random_.pick({"new MFString", "Array"}) + "(" + url() + "), " +
                  node() + ", " + quoted(random_.pick({"children", "addChildren", "nodes", "removeChildren"})) + ");");
    case 3:
    case 4: {
      const std::string out = quoted(
          random_.pick({"kids", "v", "n", "pts", "translation_changed", "children", "cycleTime", "fraction_changed"}));
      const std::string in =
          quoted(random_.pick({"nodes", "place", "one", "points", "set_translation", "addChildren", "tick", "go"}));
      return line("Browser." + random_.pick({"addRoute", "addRoute", "deleteRoute"}) + "(" + node() + ", " + out +
                  ", " + node() + ", " + in + ");");
    }
    case 5:
      return line((has(kReplaceWorld) ? "Browser.replaceWorld(" : "hold(") + list() + ");");
    case 6:
      if (!has(kLoadUrl)) return line("hold(make(3));");
      if (random_.once_in(2)) return line("Browser.loadURL(new MFString(" + quoted("next.wrl") + "), []);");
      return line("Browser.loadURL(" + list() + ", " + list() + ");");
    case 7:
      return line("kids = " + kept() + "; pts = " + kept() + "; n = " + kept() + ";");
    case 8:
      return line("print(" + any() + ", " + any() + ");");
    default:
      return line("Browser." + random_.pick({"setDescription", "setViewpoint"}) + "(" + any() + ");");
  }
}

}  // namespace gs::fuzz
