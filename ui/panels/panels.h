// The panels and dialogs of the window. Each draws into the present ImGui window or child and knows no other panel;
// what they share is the editor. Dialogs open their own windows. layout.cpp puts them together.
#pragma once
#include "editor.h"

namespace relamp::ui {

// ---- areas
/// Inside BeginMenuBar or BeginMainMenuBar: menus from the table of actions.
void drawMenuBar(Editor& editor);
/// Left column: views, emitters, environment, materials, settings of the estimate, one under the other; below them,
/// always in sight, the button that estimates.
void drawScenePanel(Editor& editor);
/// Right column: what is selected, else the scene in figures.
void drawInspectorPanel(Editor& editor);
/// Bottom: timeline, emitters, log and history as tabs, and the plan of the estimate; state.panels.bottomTab is the tab
/// shown, and may be set from outside.
void drawBottomPanel(Editor& editor);
/// What is left of it when it is folded: its tabs, and the padding above and below them.
float bottomPanelFoldedHeight();
float bottomPanelFoldedPadding();
/// In place of the viewport while nothing is open: what was open last, and the example capture.
void drawStartPage(Editor& editor);
/// One line of text high (statusBarHeight()).
void drawStatusBar(Editor& editor);
float statusBarHeight();

/// Above the viewport, while the estimate shown explains its photographs too badly to be trusted and the user has not
/// closed it.
bool qualityBannerShown(const Editor& editor);
float qualityBannerHeight(const Editor& editor, float width);
void drawQualityBanner(Editor& editor);

// ---- parts of the left column, each usable alone
void drawViewsPanel(Editor& editor);
void drawBookmarks(Editor& editor);       ///< nothing where there are none
void drawEmittersPanel(Editor& editor);   ///< shows as many columns as fit
void drawLightGroups(Editor& editor);     ///< nothing where there are none
void drawLightingStates(Editor& editor);  ///< of the photographs; nothing where there is one
void drawEnvironmentPanel(Editor& editor);
void drawMaterialsPanel(Editor& editor);
void drawEstimatePanel(Editor& editor);   ///< button and settings
void drawEstimateButton(Editor& editor);  ///< or, while it runs, how far it is
void drawEstimateSettings(Editor& editor);
void drawLightReferences(Editor& editor);  ///< panoramas of the set that the next estimate takes
/// An estimate that was stopped or killed can go on: the button for it, above the one that estimates.
bool interruptedOfferShown(const Editor& editor);
void drawInterruptedOffer(Editor& editor);
/// The search for an emitter that no photograph shows, and those that stand in its place.
void drawUnobservedLights(Editor& editor);

// ---- parts of the bottom
void drawTimelinePanel(Editor& editor);
void drawLogPanel(Editor& editor);
void drawHistoryPanel(Editor& editor);
void drawPlanPanel(Editor& editor);    ///< what an estimate does and leaves out
void drawScopePanel(Editor& editor);   ///< waveform and histogram
void drawFramesPanel(Editor& editor);  ///< the frame that is shown, keys, playing

/// Every dialog that the state asks for: notices, unsaved work, recovery, file browsers, export, keys, about, command
/// palette, import doctor. Called once a frame outside other windows, after all panels. Also closes drags whose control
/// has disappeared.
void drawDialogs(Editor& editor);
/// A dialog is open that takes the keyboard: the window's own keys rest.
bool dialogOpen(const Editor& editor);

}  // namespace relamp::ui
