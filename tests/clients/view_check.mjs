// Opens pages of `formwork view` in headless Chromium, works their controls and measures what changes.
//
//   node view_check.mjs NODE_MODULES CHROMIUM PAGE.html full|brief [SHOTS]
//
// One line of JSON for each of a desktop and a telephone: errors, requests, how much of the picture is not ground,
// and what part of its pixels each action changed. With SHOTS, screenshots go to that folder.
// A brief look is one drag on the desktop.
import { mkdtempSync, rmSync } from "node:fs";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { basename, join } from "node:path";
import { pathToFileURL } from "node:url";

const [modules, executablePath, page_, extent, shots] = process.argv.slice(2);
const { chromium } = createRequire(join(modules, "x.js"))("playwright-core");
const address = pathToFileURL(page_).href;
// The part of the picture that has to change, and the steps after which nothing may.
const SEEN = 0.0005, STILL = ["paused", "calm"];

const WINDOWS = {
  desktop: { viewport: { width: 1280, height: 800 } },
  telephone: { viewport: { width: 390, height: 844 }, isMobile: true, hasTouch: true },
};

for (const [name, window_] of Object.entries(WINDOWS).slice(0, extent === "brief" ? 1 : 2)) {
  const folder = mkdtempSync(join(tmpdir(), "formwork-view-"));
  const context = await chromium.launchPersistentContext(folder, {
    ...window_,
    executablePath,
    headless: true,
    acceptDownloads: true,
    args: ["--no-sandbox", "--disable-gpu", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
      "--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync"],
  });
  try {
    console.log(JSON.stringify({ window: name, ...(await look(context, name)) }));
  } finally {
    await context.close();
    rmSync(folder, { recursive: true, force: true });
  }
}

async function look(context, name) {
  const errors = [], requests = [];
  // Pages of any kind: a request by a worker or an icon counts too.
  context.on("request", (request) => {
    const url = request.url();
    if (url !== address && !url.startsWith("data:") && !url.startsWith("blob:")) requests.push(url);
  });
  const page = await context.newPage();
  page.setDefaultTimeout(120000);
  page.on("console", (message) => {
    // That a screenshot makes a software driver wait is not the page's doing.
    if (message.text().includes("GPU stall due to ReadPixels")) return;
    if (["error", "warning"].includes(message.type())) errors.push(message.text());
  });
  page.on("pageerror", (error) => errors.push(String(error)));
  await page.goto(address);
  await page.waitForSelector("html[data-ready]", { timeout: 120000 });
  const ready = Number(await page.evaluate(() => document.documentElement.dataset.ready));

  // Another page compares pictures, in no page's way.
  const lab = await context.newPage();
  await lab.goto("data:text/html,<title>lab</title>");
  await page.bringToFront();
  const shot = async (label) => {
    // Two frames, so that what was asked for is there.
    await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
    const path = shots && label ? join(shots, `${basename(page_, ".html")}-${name}-${label}.png`) : undefined;
    return (await page.screenshot({ path })).toString("base64");
  };
  const changed = (a, b) => lab.evaluate(difference, [a, b]);

  const view = await page.evaluate(() => {
    const panel = document.getElementById("panel").getBoundingClientRect(), narrow = innerWidth <= 720;
    return { x: (narrow ? innerWidth : panel.left) / 2, y: narrow ? panel.top / 2 + 40 : innerHeight / 2 };
  });
  const results = {};
  let before = await shot("first");
  // A busy machine draws late: what is to change something has 30 seconds for it, unless the look is brief, and what is to
  // come to rest ten tries.
  const patience = extent === "brief" ? 2 : 60;
  const step = async (label, act, settle = 0) => {
    await act();
    if (settle) await page.waitForTimeout(settle);
    let after = await shot(label);
    results[label] = await changed(before, after);
    const still = STILL.includes(label);
    for (let i = 0; still ? i < 10 && results[label] > 0 : i < patience && results[label] < SEEN; i++) {
      if (still) before = after;
      await page.waitForTimeout(500);
      after = await shot(label);
      results[label] = await changed(before, after);
    }
    before = after;
  };

  const covered = await lab.evaluate(coverage, before);
  const has = (selector) => page.locator(selector).first().isEnabled();
  const flows = await has("input[name=strokes]");
  if (flows) {
    await step("flowing", async () => {}, 400);
    await step("key-space", () => page.keyboard.press("Space"));
    await step("paused", async () => {}, 400);
  }
  const drag = name === "telephone" ? touchDrag : mouseDrag;
  await step("drag", () => drag(page, view), 900);
  if (extent === "brief") return { errors, requests, ready, covered, changed: results };
  await step("key-arrow", () => page.keyboard.press("ArrowLeft"), 100);
  await step("key-plus", () => page.keyboard.press("+"), 100);
  await step("key-reset", () => page.keyboard.press("r"), 600);
  for (const degree of ["2", "0", "none", "1"]) {
    if (await has(`input[name=degree][value="${degree}"]`)) {
      await step(`form-${degree}`, () => page.locator(`label:has(input[name=degree][value="${degree}"])`).click());
    }
  }
  for (const layer of ["strokes", "arrows", "zeros", "creases", "cage", "mesh"]) {
    if (await has(`input[name=${layer}]`)) {
      await step(`switch-${layer}`, () => page.locator(`label:has(input[name=${layer}])`).click());
    }
  }
  await step("level", () => page.locator("#level").fill("0"));
  await step("key-level", () => page.keyboard.press("]"));
  await step("theme", () => page.locator("#theme").click());
  await step("help", () => page.keyboard.press("?"));
  await page.keyboard.press("Escape");
  const download = page.waitForEvent("download");
  await page.keyboard.press("s");
  const saved = (await download).suggestedFilename();

  const layout = await page.evaluate(() => {
    const inside = (element) => {
      const box = element.getBoundingClientRect();
      return box.left >= -1 && box.right <= innerWidth + 1 && box.top >= -1 && box.bottom <= innerHeight + 1;
    };
    const all = [...document.querySelectorAll("#panel button, #panel label, #scale, header")];
    const seen = all.filter((element) => element.getClientRects().length > 0);
    const size = (element) => parseFloat(getComputedStyle(element).fontSize);
    const unnamed = [...document.querySelectorAll("button, input, canvas")].filter(
      (element) => !(element.getAttribute("aria-label") || element.labels?.length || element.textContent.trim()));
    return {
      outside: seen.filter((element) => !inside(element)).map((element) => element.textContent.trim() || element.id),
      scrolls: document.documentElement.scrollWidth > innerWidth,
      smallest: Math.min(...seen.map(size)),
      unnamed: unnamed.length,
    };
  });
  await page.emulateMedia({ reducedMotion: "reduce" });
  await page.reload();
  await page.waitForSelector("html[data-ready]");
  before = await shot();
  await step("calm", async () => {}, 400);
  return { errors, requests, ready, covered, changed: results, saved, ...layout };
}

async function mouseDrag(page, { x, y }) {
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.mouse.move(x + 90, y + 30, { steps: 4 });
  await page.mouse.up();
}

async function touchDrag(page, { x, y }) {
  const client = await page.context().newCDPSession(page);
  const touch = (type, points) => client.send("Input.dispatchTouchEvent", { type, touchPoints: points });
  await touch("touchStart", [{ x, y }]);
  for (let i = 1; i <= 4; i++) await touch("touchMove", [{ x: x + 20 * i, y: y + 8 * i }]);
  await touch("touchEnd", []);
}

// In the laboratory.

/** The part of the pixels that differ. */
async function difference(pictures) {
  const [a, b] = await Promise.all(pictures.map(async (base64) => {
    const image = new Image();
    image.src = `data:image/png;base64,${base64}`;
    await image.decode();
    const paper = new OffscreenCanvas(image.width, image.height).getContext("2d");
    paper.drawImage(image, 0, 0);
    return paper.getImageData(0, 0, image.width, image.height).data;
  }));
  let count = 0;
  for (let i = 0; i < a.length; i += 4) {
    const apart = Math.max(...[0, 1, 2].map((k) => Math.abs(a[i + k] - b[i + k])));
    if (apart > 12) count++;
  }
  return (4 * count) / a.length;
}

/** The part of the middle of a picture that is not of the colour of its upper edge, and its number of colours. */
async function coverage(base64) {
  const image = new Image();
  image.src = `data:image/png;base64,${base64}`;
  await image.decode();
  const paper = new OffscreenCanvas(image.width, image.height).getContext("2d");
  paper.drawImage(image, 0, 0);
  const [width, height] = [image.width, image.height], data = paper.getImageData(0, 0, width, height).data;
  const ground = data.slice(4 * (width >> 1), 4 * (width >> 1) + 3), colours = new Set();
  const middle = (y) => y > height * 0.2 && y < height * 0.55, beside = (x) => x < width * 0.7;
  let count = 0, all = 0;
  for (let y = 0; y < height; y++) {
    for (let x = 0; x < width; x++) {
      if (!middle(y) || !beside(x)) continue;
      const i = 4 * (y * width + x);
      all++;
      if ([0, 1, 2].some((k) => Math.abs(data[i + k] - ground[k]) > 12)) count++;
      colours.add((data[i] << 16) | (data[i + 1] << 8) | data[i + 2]);
    }
  }
  return { part: count / all, colours: colours.size };
}
