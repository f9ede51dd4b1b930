// The leg in the hand of a pointer: grabbed, swept to and fro, and how soon that is seen.

/** The angle that the page shows, °. */
export const angleOf = (page) =>
  page.evaluate(() => Number(document.getElementById("angle").textContent.replace("−", "-")));

/** The places on the screen at angles about the knee, °, seen from the side. */
async function placesOf(page) {
  const { x, y, width, height } = await page.locator("#leg svg").boundingBox();
  const [knee, reach] = [{ x: x + (width * 150) / 300, y: y + (height * 62) / 212 }, width * 0.3];
  return (deg) => {
    const rad = (deg * Math.PI) / 180;
    return [knee.x + reach * Math.cos(rad), knee.y + reach * Math.sin(rad)];
  };
}

/** The place on the screen at an angle about the knee, °. */
export const at = async (page, deg) => (await placesOf(page))(deg);

/** Grabs the leg at this place; returns its angle once it rests in the hand. */
export async function grab(page, deg) {
  await page.locator("#leg").scrollIntoViewIfNeeded();
  await page.mouse.move(...(await at(page, deg)));
  await page.mouse.down();
  await page.locator("#hand-release").waitFor();
  await page.waitForTimeout(700);
  return angleOf(page);
}

/** Moves the pointer from one angle to another, °, at this speed, °/s. */
export async function sweep(page, from, to, speed = 60) {
  const place = await placesOf(page);
  const whole = Math.abs(to - from);
  const began = performance.now();
  for (let turned = 0; turned < whole; ) {
    turned = Math.min(whole, (speed * (performance.now() - began)) / 1000);
    await page.mouse.move(...place(from + Math.sign(to - from) * turned));
    await page.waitForTimeout(10);
  }
}

/** The angle of the hand as it is drawn, °; that of the leg where both are close. */
const handOf = (page) =>
  page.evaluate(() => {
    const [ghost, leg] = [document.querySelector("#leg .ghost"), document.querySelector("#leg g")];
    const drawn = ghost.getAttribute("visibility") === "visible" ? ghost : leg;
    return Number(/rotate\((-?[\d.]+)/.exec(drawn.getAttribute("transform"))[1]);
  });

/** Grabs the leg, wherever it is; the returned function moves the hand to an angle of the leg, °, at a speed, °/s. */
export async function takeLeg(page) {
  await grab(page, 40);
  let hand = await handOf(page);
  // The pointer keeps its distance to the hand.
  const ahead = 40 - hand;
  return async (to, speed) => {
    await sweep(page, hand + ahead, to + ahead, speed);
    hand = to;
  };
}

/** From now on measures the time from a move of the pointer to a picture with another angle of the leg. */
export const watchDelays = (page) =>
  page.evaluate(() => {
    window.delays = [];
    const leg = document.querySelector("#leg g");
    const turn = () => Number(/rotate\((-?[\d.]+)/.exec(leg.getAttribute("transform"))[1]);
    document.getElementById("leg").addEventListener(
      "pointermove",
      ({ timeStamp }) => {
        const before = turn();
        const look = () => {
          const delay = performance.now() - timeStamp;
          if (Math.abs(turn() - before) >= 0.3) window.delays.push(delay);
          else if (delay < 500) requestAnimationFrame(look);
        };
        requestAnimationFrame(look);
      },
      { capture: true },
    );
  });

/** Moves the pointer, which has grabbed the leg at 40°, so many times; returns the times to the picture, ms, sorted. */
export async function delaysOf(page, moves) {
  await page.evaluate(() => (window.delays.length = 0));
  for (let nth = 0; nth < moves; nth++) {
    await page.mouse.move(...(await at(page, nth % 2 ? 40 : 60)));
    await page.waitForTimeout(600);
  }
  return page.evaluate(() => window.delays.sort((a, b) => a - b));
}
