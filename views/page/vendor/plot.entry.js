// What page/figures.js takes of Observable Plot; update-vendor bundles it as the global Plot.
export {
  plot, areaY, axisX, axisY, barX, barY, dot, gridX, gridY, hexbin, line, lineY, link, rect, rectY, ruleX, ruleY, text,
  tickX, tickY, axisFx
} from "@observablehq/plot";
