"""Colours and layout of the page."""

from __future__ import annotations

PRIMARY = "#3577bd"
"""Colour of the header and of buttons, on which white letters have a contrast of 4.6."""

STYLE = """
@layer theme {
  .text-positive { color: #1a7f37 !important }
  .text-warning, .text-orange-9 { color: #8a5a00 !important }
  .text-grey { color: #6b6b6b !important }
  .q-notification.bg-warning .q-btn { color: black !important }
  .body--dark .text-primary { color: #7db4ea !important }
  .body--dark .text-negative { color: #ff8a80 !important }
  .body--dark .text-positive { color: #5fd38a !important }
  .body--dark .text-warning, .body--dark .text-orange-9 { color: #ffb74d !important }
  .body--dark .text-grey { color: #a8a8a8 !important }
}
.swgpar-queue { max-height: 34vh; overflow-y: auto; flex-wrap: nowrap }
.swgpar-columns { flex-wrap: nowrap }
.swgpar-parts { display: none }
.swgpar-form { width: 330px; max-height: calc(100vh - 104px); overflow-y: auto; flex: none }
.swgpar-section { flex: 1 1 400px; min-width: 0 }
.swgpar-plot { height: calc(100vh - 215px); min-height: 320px }
.swgpar-half { height: calc(50vh - 140px); min-height: 240px }
.swgpar-answers { width: 340px; max-height: calc(100vh - 104px); overflow-y: auto; flex: none;
  flex-wrap: nowrap }
.swgpar-answers > * { flex-shrink: 0 }
.swgpar-answers td { overflow-wrap: anywhere }
.body--dark .swgpar-answers .q-table__card { background: transparent }
.swgpar-loaded td:not(:first-child) { white-space: nowrap }
.swgpar-answers th:first-child, .swgpar-answers td:first-child { padding-left: 0 }
.swgpar-slider { width: 100%; height: 4px; border-radius: 2px; appearance: none;
  background: #8c8c8c80; margin: 8px 0; cursor: pointer }
.swgpar-slider::-webkit-slider-thumb { appearance: none; width: 16px; height: 16px;
  border-radius: 50%; background: var(--q-primary) }
.swgpar-slider::-moz-range-thumb { border: 0; width: 16px; height: 16px; border-radius: 50%;
  background: var(--q-primary) }
.swgpar-slider:focus-visible { outline: 2px solid var(--q-primary); outline-offset: 6px }
.swgpar-slider:disabled { opacity: 0.4 }
.swgpar-angle { width: 3em; text-align: right }
.swgpar-toggle .q-btn { padding: 2px 10px }
.swgpar-plot .main-svg > g:not(.hoverlayer) text { fill: #505050 !important }
.body--dark .swgpar-plot .main-svg > g:not(.hoverlayer) text { fill: #c8c8c8 !important }
.swgpar-view { border: 0 }
.swgpar-search { width: min(90vw, 900px); max-width: none }
.swgpar-drawings { width: min(90vw, 1000px); max-width: none }
.swgpar-drawings img { background: white }
.swgpar-text { max-height: 60vh; overflow: auto; user-select: all }
.swgpar-log { white-space: pre-wrap; font-family: monospace; font-size: 11px }
@media (max-width: 1000px) {
  .swgpar-columns { flex-wrap: wrap }
  .swgpar-form, .swgpar-answers, .swgpar-section { width: 100%; max-height: none; flex: 1 1 100% }
  .swgpar-header { gap: 2px 8px }
  .swgpar-plot { height: 45vh }
  .swgpar-half { height: 35vh }
  .swgpar-section { order: -2 }
  .swgpar-parts { display: flex; order: -1; width: 100% }
  .swgpar-shows-keys > .swgpar-answers, .swgpar-shows-answers > .swgpar-form { display: none }
}
"""
"""Texts have a contrast of 4.5 and more, on white and on black. Of important rules
those of the first layer count."""
