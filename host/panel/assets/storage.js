// Storage of the browser, which may be blocked: then the page works without it.

/** Returns what is stored for this address under a key, or null. */
export function stored(key) {
  try {
    return localStorage.getItem(key);
  } catch {
    return null;
  }
}

/** Stores a choice; without storage it lasts until the page is left. */
export function store(key, value) {
  try {
    localStorage.setItem(key, value);
  } catch {
    // Blocked or full.
  }
}

let token = "";

/** Returns the key of this tab's link, or "". */
export function storedToken() {
  try {
    return sessionStorage.getItem("token") ?? token;
  } catch {
    return token;
  }
}

/** Keeps the key of this tab's link; returns whether it survives a reload. */
export function storeToken(value) {
  token = value;
  try {
    sessionStorage.setItem("token", value);
    return true;
  } catch {
    return false;
  }
}
