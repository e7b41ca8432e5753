/** What moves a panel, where panels can be moved: it stands at the panel's title. */
import { createContext, type ReactNode } from "react";

export const PanelHandleContext = createContext<ReactNode>(null);
